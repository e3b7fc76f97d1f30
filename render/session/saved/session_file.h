#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "render/session/saved/saved_session.h"

namespace condyle {

/// Format, version and ending of session files.
constexpr const char* session_format = "condyle session";
constexpr int session_version = 1;
constexpr const char* session_ending = ".condyle-session";

/// The text of a session file: JSON, from which parse_session() reads each number back to the bit.
/// Files below the folder of `file` are named relative to it.
std::string session_json(const SavedSession& session, const std::filesystem::path& file);

/// throws: InputError naming the file, the item and its value: text that is no JSON or only part of
/// it, another format, a newer version, unknown keys, values out of range.
SavedSession parse_session(const std::filesystem::path& file, std::string_view text);
SavedSession load_session(const std::filesystem::path& file);

/// Refuses a session whose patient or plan is not where it says. throws: InputError.
void check_session_files(const SavedSession& session, const std::filesystem::path& file);

}  // namespace condyle
