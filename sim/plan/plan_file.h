#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "sim/plan/plan.h"

namespace condyle {

/// Format and version stated in a plan file.
constexpr const char* plan_format = "condyle plan";
constexpr int plan_version = 2;

/// The version that a plan is written as: 1, which has neither trims nor zones, where it is enough.
int version_of(const Plan& plan);

/// The text of a plan file: JSON, from which parse_plan() reads each number back to the bit.
std::string plan_json(const Plan& plan);

/// Hash of plan_json(): 16 hexadecimal digits.
std::string plan_hash(const Plan& plan);

/// throws: InputError naming the file, the item and its value: text that is no JSON or only part of
/// it, another format, a newer version, unknown keys, and whatever check_plan() refuses.
Plan parse_plan(const std::filesystem::path& file, std::string_view text);
Plan load_plan(const std::filesystem::path& file);

/// plan_json() of a plan that can be read back from `file`. throws: InputError for any other.
std::string checked_plan_json(const Plan& plan, const std::filesystem::path& file);

/// Written beside the file and renamed: what was there stays intact on failure.
/// throws: InputError for a plan that could not be read back; MachineError.
void save_plan(const Plan& plan, const std::filesystem::path& file);

}  // namespace condyle
