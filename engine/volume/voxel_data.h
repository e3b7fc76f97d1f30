#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "engine/volume/volume.h"

namespace condyle {

enum class VoxelType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
/// Size of one value.
std::size_t bytes_of(VoxelType type);

/// How values are stored.
struct VoxelCoding {
  VoxelType type = VoxelType::int16;
  bool big_endian = false;
  double slope = 1, intercept = 0;  // Hounsfield units = slope * value + intercept
};

/// The fields of a text header by their names in lower case.
using HeaderFields = std::map<std::string, std::string>;
constexpr std::size_t longest_header = std::size_t{1} << 16;  // bytes

/// The value of the first of the names that is there; `shown`: the usual one, as it is written.
/// throws: InputError if none is there.
const std::string& required(const HeaderFields& fields, std::initializer_list<const char*> names,
                            const char* shown, const std::filesystem::path& file);

/// Number of bytes of a volume of this size. throws: InputError for a size below 2 along an axis,
/// and for more than 2^31 values.
std::size_t byte_count(const std::array<int, 3>& size, VoxelType type,
                       const std::filesystem::path& file);

/// throws: InputError unless the data has as many bytes as the header states.
void check_length(std::size_t bytes, std::size_t promised, const std::filesystem::path& file);

/// Values in whole Hounsfield units, limited to 16 bits; NaN becomes -32768.
std::vector<std::int16_t> decoded(std::string_view bytes, const VoxelCoding& coding);

/// Takes axes, spacing and origin from the steps between neighbours, columns in LPS, mm.
/// throws: InputError for steps that are not perpendicular, and for spacings that are not finite or
/// not between 0.001 and 100 mm.
void set_geometry(Volume& volume, const Eigen::Matrix3d& steps, const Eigen::Vector3d& origin,
                  const std::filesystem::path& file, const std::string& item);

/// A file in the folder of the header, by its name there. throws: InputError for a name that leads
/// elsewhere.
std::filesystem::path data_file_beside(const std::filesystem::path& header,
                                       const std::string& name);

/// The number that a text states. throws: InputError naming file and item.
double number_in(const std::string& text, const std::filesystem::path& file,
                 const std::string& item);
/// The same for a whole number below 2^31.
int count_in(const std::string& text, const std::filesystem::path& file, const std::string& item);

/// The three numbers of values that a text states. throws: InputError naming file and item.
std::array<int, 3> sizes_in(const std::string& text, const std::filesystem::path& file,
                            const std::string& item);

/// Without blanks at both ends.
std::string trimmed(const std::string& text);
std::string lower_case(std::string text);

}  // namespace condyle
