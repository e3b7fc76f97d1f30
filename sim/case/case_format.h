#pragma once

#include <cstddef>
#include <string>

namespace condyle {

/// Format and version stated in case.json.
constexpr const char* case_format = "condyle case";
// 1: a segment or transplant names its carrier, cranium or mandible. 2: bodies and their parents;
// canals, where there are any.
constexpr int case_version = 2;
constexpr const char* muscles_file = "muscles.csv";
constexpr const char* face_muscles_file = "face_muscles.csv";
constexpr const char* mechanics_file = "mechanics.json";
constexpr double max_scan_opening_mm = 60;
constexpr std::size_t max_case_json_bytes = std::size_t{16} << 20;

/// Letters, digits, '-' and '_': a part's name is also its file name.
bool is_part_name(const std::string& name);

/// 11 to 48 without the gaps, and deciduous teeth 51 to 85.
bool is_fdi(int number);

}  // namespace condyle
