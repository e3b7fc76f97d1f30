#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace condyle {

/// Whole content of a regular file.
/// throws: InputError naming the file when it is missing, a folder, unreadable or larger than
/// `max_bytes`.
std::string read_file(const std::filesystem::path& file,
                      std::size_t max_bytes = std::size_t{4} << 30);

/// Writes beside the target, then renames: the old content stays intact on any failure. throws:
/// MachineError naming the file and the system's reason (disk full, not writable).
void write_file(const std::filesystem::path& file, std::string_view content);

/// Creates the folder and its parents. throws: MachineError naming the folder and the reason.
void make_folder(const std::filesystem::path& folder);

}  // namespace condyle
