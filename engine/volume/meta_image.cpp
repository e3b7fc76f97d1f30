#include <Eigen/Core>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <optional>
#include <sstream>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/volume/unpack.h"
#include "engine/volume/volume_readers.h"
#include "engine/volume/voxel_data.h"

// source: MetaIO documentation, itk.org/Wiki/ITK/MetaIO/Documentation; the physical axes are LPS.

namespace condyle {
namespace {

namespace fs = std::filesystem;
/// The fields of the header by their names in lower case, the last one naming the data; `end` is
/// where data in the same file begins.
HeaderFields meta_fields(const std::string& content, const fs::path& file, std::size_t& end) {
  HeaderFields fields;
  end = 0;
  while (!fields.contains("elementdatafile")) {
    const auto stop = content.find('\n', end);
    if (end >= content.size() ||
        (stop == std::string::npos ? content.size() : stop) > longest_header)
      throw InputError(file, "ElementDataFile", "is missing in the header");
    const std::string line = trimmed(content.substr(end, stop - end));
    end = stop == std::string::npos ? content.size() : stop + 1;
    if (line.empty()) continue;
    const auto equal = line.find('=');
    if (equal == std::string::npos)
      throw InputError(file, "header", "\"" + line.substr(0, 60) + "\" is not a field");
    fields[lower_case(trimmed(line.substr(0, equal)))] = trimmed(line.substr(equal + 1));
  }
  return fields;
}

template <std::size_t count>
std::array<double, count> numbers_in(const std::string& text, const fs::path& file,
                                     const char* item) {
  std::array<double, count> numbers;
  std::istringstream words(text);
  std::string word;
  for (double& number : numbers) {
    if (!(words >> word))
      throw InputError(file, item, "has fewer than " + std::to_string(count) + " numbers");
    number = number_in(word, file, item);
  }
  if (words >> word)
    throw InputError(file, item, "has more than " + std::to_string(count) + " numbers");
  return numbers;
}

/// Whether the first field that is there says so; none: `otherwise`.
bool is_true(const HeaderFields& fields, std::initializer_list<const char*> names,
             const char* shown, std::optional<bool> otherwise, const fs::path& file) {
  for (const char* name : names)
    if (const auto found = fields.find(name); found != fields.end()) {
      const std::string word = lower_case(found->second);
      if (word == "true" || word == "1") return true;
      if (word == "false" || word == "0") return false;
      throw InputError(file, shown,
                       "\"" + found->second.substr(0, 60) + "\" is neither True nor False");
    }
  if (!otherwise) throw InputError(file, shown, "is missing in the header");
  return *otherwise;
}

VoxelType meta_type(const std::string& text, const fs::path& file) {
  static const std::map<std::string, VoxelType> known = {
      {"MET_CHAR", VoxelType::int8},     {"MET_UCHAR", VoxelType::uint8},
      {"MET_SHORT", VoxelType::int16},   {"MET_USHORT", VoxelType::uint16},
      {"MET_INT", VoxelType::int32},     {"MET_UINT", VoxelType::uint32},
      {"MET_FLOAT", VoxelType::float32}, {"MET_DOUBLE", VoxelType::float64}};
  const auto found = known.find(text);
  if (found == known.end()) throw InputError(file, "ElementType", "\"" + text + "\" is not read");
  return found->second;
}

}  // namespace

Volume read_meta_image(const fs::path& file) {
  std::string content = read_file(file);
  std::size_t begin = 0;
  const HeaderFields fields = meta_fields(content, file, begin);
  if (const std::string& dimension = required(fields, {"ndims"}, "NDims", file);
      count_in(dimension, file, "NDims") != 3)
    throw InputError(file, "NDims", "is " + dimension + "; a volume has 3");
  if (const auto channels = fields.find("elementnumberofchannels");
      channels != fields.end() && channels->second != "1")
    throw InputError(file, "ElementNumberOfChannels", "is " + channels->second + "; it must be 1");
  Volume volume;
  volume.size = sizes_in(required(fields, {"dimsize"}, "DimSize", file), file, "DimSize");
  const auto spacing = numbers_in<3>(required(fields, {"elementspacing"}, "ElementSpacing", file),
                                     file, "ElementSpacing");
  // Each three numbers are the direction of an axis.
  const auto turn = numbers_in<9>(
      required(fields, {"transformmatrix", "rotation", "orientation"}, "TransformMatrix", file),
      file, "TransformMatrix");
  const auto origin = numbers_in<3>(
      required(fields, {"offset", "position", "origin"}, "Offset", file), file, "Offset");
  Eigen::Matrix3d steps;
  for (int a = 0; a < 3; ++a) {
    const auto first = static_cast<std::size_t>(3 * a);
    if (!(spacing[static_cast<std::size_t>(a)] > 0))
      throw InputError(file, "ElementSpacing", "is not positive along each axis");
    if (const double length = std::hypot(turn[first], turn[first + 1], turn[first + 2]);
        !(std::abs(length - 1) < 1e-3))
      throw InputError(file, "TransformMatrix", "a direction does not have length 1");
    for (int c = 0; c < 3; ++c)
      steps(c, a) =
          turn[first + static_cast<std::size_t>(c)] * spacing[static_cast<std::size_t>(a)];
  }
  set_geometry(volume, steps, {origin[0], origin[1], origin[2]}, file, "TransformMatrix");

  VoxelCoding coding;
  coding.type = meta_type(required(fields, {"elementtype"}, "ElementType", file), file);
  if (bytes_of(coding.type) > 1)
    coding.big_endian = is_true(fields, {"binarydatabyteordermsb", "elementbyteordermsb"},
                                "BinaryDataByteOrderMSB", std::nullopt, file);
  if (!is_true(fields, {"binarydata"}, "BinaryData", false, file))
    throw InputError(file, "BinaryData", "must be True: numbers as text are not read");
  if (const auto skipped = fields.find("headersize");
      skipped != fields.end() && skipped->second != "0")
    throw InputError(file, "HeaderSize", "is " + skipped->second + ": skipped data is not read");
  const std::size_t promised = byte_count(volume.size, coding.type, file);
  const std::string& name = fields.at("elementdatafile");
  fs::path source = file;
  if (lower_case(name) != "local") {
    source = data_file_beside(file, name);
    content = read_file(source);
    begin = 0;
  }
  const std::string_view data = std::string_view(content).substr(begin);
  if (is_true(fields, {"compresseddata"}, "CompressedData", false, file)) {
    volume.values = decoded(unpack(data, promised, source), coding);
  } else {
    check_length(data.size(), promised, source);
    volume.values = decoded(data, coding);
  }
  return volume;
}

}  // namespace condyle
