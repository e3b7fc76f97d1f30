#include "engine/volume/voxel_data.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>

#include "engine/core/error.h"

namespace condyle {
namespace {

constexpr std::size_t most_values = std::size_t{1} << 31;
constexpr double least_spacing_mm = 1e-3, most_spacing_mm = 100;
constexpr double most_shear = 1e-3;  // cosine between two axes: 0.06 degrees

template <class Stored>
void decode(std::string_view bytes, const VoxelCoding& coding, std::vector<std::int16_t>& values) {
  constexpr double low = std::numeric_limits<std::int16_t>::min(),
                   high = std::numeric_limits<std::int16_t>::max();
  const bool swaps = coding.big_endian != (std::endian::native == std::endian::big);
  for (std::size_t i = 0; i < values.size(); ++i) {
    char one[sizeof(Stored)];
    std::memcpy(one, bytes.data() + i * sizeof(Stored), sizeof(Stored));
    if (swaps) std::reverse(one, one + sizeof(Stored));
    Stored stored;
    std::memcpy(&stored, one, sizeof(Stored));
    const double value = coding.slope * static_cast<double>(stored) + coding.intercept;
    values[i] = static_cast<std::int16_t>(
        std::isnan(value) ? low : std::round(std::clamp(value, low, high)));
  }
}

/// The number that the whole text states; none for another text.
template <class Number>
std::optional<Number> parsed(const std::string& text) {
  Number value = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

}  // namespace

std::size_t bytes_of(VoxelType type) {
  switch (type) {
    case VoxelType::int8:
    case VoxelType::uint8:
      return 1;
    case VoxelType::int16:
    case VoxelType::uint16:
      return 2;
    case VoxelType::float64:
      return 8;
    default:
      return 4;
  }
}

const std::string& required(const HeaderFields& fields, std::initializer_list<const char*> names,
                            const char* shown, const std::filesystem::path& file) {
  for (const char* name : names)
    if (const auto found = fields.find(name); found != fields.end()) return found->second;
  throw InputError(file, shown, "is missing in the header");
}

std::size_t byte_count(const std::array<int, 3>& size, VoxelType type,
                       const std::filesystem::path& file) {
  std::size_t count = 1;
  for (const int n : size) {
    if (n < 2)
      throw InputError(file, "size",
                       "is " + std::to_string(n) +
                           " along an axis; a volume has at "
                           "least 2 values along each");
    count *= static_cast<std::size_t>(n);  // of two factors below 2^31 it does not overflow
    if (count > most_values)
      throw InputError(file, "size", "it states more than 2147483648 values");
  }
  return count * bytes_of(type);
}

void check_length(std::size_t bytes, std::size_t promised, const std::filesystem::path& file) {
  if (bytes != promised)
    throw InputError(file, "",
                     "has " + std::to_string(bytes) + " bytes of data where its header states " +
                         std::to_string(promised));
}

std::vector<std::int16_t> decoded(std::string_view bytes, const VoxelCoding& coding) {
  std::vector<std::int16_t> values(bytes.size() / bytes_of(coding.type));
  switch (coding.type) {
    case VoxelType::int8:
      decode<std::int8_t>(bytes, coding, values);
      break;
    case VoxelType::uint8:
      decode<std::uint8_t>(bytes, coding, values);
      break;
    case VoxelType::int16:
      decode<std::int16_t>(bytes, coding, values);
      break;
    case VoxelType::uint16:
      decode<std::uint16_t>(bytes, coding, values);
      break;
    case VoxelType::int32:
      decode<std::int32_t>(bytes, coding, values);
      break;
    case VoxelType::uint32:
      decode<std::uint32_t>(bytes, coding, values);
      break;
    case VoxelType::float32:
      decode<float>(bytes, coding, values);
      break;
    case VoxelType::float64:
      decode<double>(bytes, coding, values);
      break;
  }
  return values;
}

void set_geometry(Volume& volume, const Eigen::Matrix3d& steps, const Eigen::Vector3d& origin,
                  const std::filesystem::path& file, const std::string& item) {
  if (!steps.allFinite() || !origin.allFinite())
    throw InputError(file, item, "a number is not finite");
  for (int a = 0; a < 3; ++a) {
    volume.spacing_mm[a] = steps.col(a).norm();
    if (volume.spacing_mm[a] == 0) throw InputError(file, item, "a spacing is zero");
    if (!(volume.spacing_mm[a] >= least_spacing_mm && volume.spacing_mm[a] <= most_spacing_mm))
      throw InputError(file, item, "a spacing is not between 0.001 and 100 mm");
    volume.axes.col(a) = steps.col(a) / volume.spacing_mm[a];
  }
  for (int a = 0; a < 3; ++a) {
    const double cosine = volume.axes.col(a).dot(volume.axes.col((a + 1) % 3));
    if (std::abs(cosine) > most_shear) {
      const double degrees =
          90 - std::acos(std::min(std::abs(cosine), 1.0)) * 180 / std::numbers::pi;
      char words[64];
      std::snprintf(words, sizeof words, "the axes are sheared by %.1f degrees", degrees);
      throw InputError(file, item,
                       std::string(words) + ", as by a tilted gantry: resample the scan");
    }
  }
  volume.origin = origin;
}

std::filesystem::path data_file_beside(const std::filesystem::path& header,
                                       const std::string& name) {
  const std::filesystem::path data = name;
  if (name.empty() || data.has_parent_path() || name == "." || name == "..")
    throw InputError(header, "data file",
                     "is \"" + name + "\"; it must be a file in the folder of the header");
  return header.parent_path() / data;
}

double number_in(const std::string& text, const std::filesystem::path& file,
                 const std::string& item) {
  const auto value = parsed<double>(text);
  if (!value || !std::isfinite(*value))
    throw InputError(file, item, "\"" + text.substr(0, 60) + "\" is not a number");
  return *value;
}

int count_in(const std::string& text, const std::filesystem::path& file, const std::string& item) {
  const auto value = parsed<int>(text);
  if (!value)
    throw InputError(file, item, "\"" + text.substr(0, 60) + "\" is not a whole number below 2^31");
  return *value;
}

std::array<int, 3> sizes_in(const std::string& text, const std::filesystem::path& file,
                            const std::string& item) {
  std::array<int, 3> sizes;
  std::istringstream words(text);
  std::string word;
  for (int& n : sizes) {
    if (!(words >> word)) throw InputError(file, item, "has fewer than 3 numbers");
    n = count_in(word, file, item);
  }
  if (words >> word) throw InputError(file, item, "has more than 3 numbers");
  return sizes;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace condyle
