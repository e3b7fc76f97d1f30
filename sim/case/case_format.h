#pragma once

#include <cstddef>
#include <string>

namespace condyle {

/// What a case folder's case.json says of itself.
constexpr const char* case_format = "condyle case";
constexpr int case_version = 1;
constexpr const char* muscles_file = "muscles.csv";
constexpr const char* mechanics_file = "mechanics.json";
constexpr std::size_t max_case_json_bytes = std::size_t{16} << 20;

/// Letters, digits, '-' and '_': a part's name is its file's name too.
bool is_part_name(const std::string& name);

/// 11 to 48 without the gaps, and the milk teeth 51 to 85.
bool is_fdi(int number);

}  // namespace condyle
