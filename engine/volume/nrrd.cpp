#include <Eigen/Core>
#include <map>
#include <sstream>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/volume/unpack.h"
#include "engine/volume/volume_readers.h"
#include "engine/volume/voxel_data.h"

// source: the definition of the NRRD file format, teem.sourceforge.net/nrrd/format.html

namespace condyle {
namespace {

namespace fs = std::filesystem;
/// The fields of the header by their names in lower case without blanks; `end` is where the data
/// begins.
HeaderFields nrrd_fields(const std::string& content, const fs::path& file, std::size_t& end) {
  HeaderFields fields;
  end = 0;
  for (bool first = true;; first = false) {
    const auto stop = content.find('\n', end);
    if (stop == std::string::npos || stop > longest_header) {
      // A header without data may end with its last line.
      if (first || stop != std::string::npos || content.size() > longest_header)
        throw InputError(file, "", "its header does not end");
    }
    const std::string line = trimmed(content.substr(end, stop - end));
    end = stop == std::string::npos ? content.size() : stop + 1;
    if (first) {
      if (!line.starts_with("NRRD000")) throw InputError(file, "", "does not begin with NRRD000");
      continue;
    }
    if (line.empty()) break;
    if (line[0] != '#') {
      const auto colon = line.find(':');
      if (colon == std::string::npos)
        throw InputError(file, "header", "\"" + line.substr(0, 60) + "\" is not a field");
      if (line.compare(colon, 2, ":=") != 0) {
        std::string name = lower_case(line.substr(0, colon));
        std::erase(name, ' ');
        fields[name] = trimmed(line.substr(colon + 1));
      }
    }
    if (end == content.size()) break;
  }
  return fields;
}

VoxelType nrrd_type(const std::string& text, const fs::path& file) {
  static const std::map<std::string, VoxelType> known = {{"int8", VoxelType::int8},
                                                         {"int8_t", VoxelType::int8},
                                                         {"signed char", VoxelType::int8},
                                                         {"uint8", VoxelType::uint8},
                                                         {"uint8_t", VoxelType::uint8},
                                                         {"uchar", VoxelType::uint8},
                                                         {"unsigned char", VoxelType::uint8},
                                                         {"int16", VoxelType::int16},
                                                         {"int16_t", VoxelType::int16},
                                                         {"short", VoxelType::int16},
                                                         {"short int", VoxelType::int16},
                                                         {"signed short", VoxelType::int16},
                                                         {"signed short int", VoxelType::int16},
                                                         {"unsigned short int", VoxelType::uint16},
                                                         {"uint16", VoxelType::uint16},
                                                         {"uint16_t", VoxelType::uint16},
                                                         {"ushort", VoxelType::uint16},
                                                         {"unsigned short", VoxelType::uint16},
                                                         {"int32", VoxelType::int32},
                                                         {"int32_t", VoxelType::int32},
                                                         {"int", VoxelType::int32},
                                                         {"signed int", VoxelType::int32},
                                                         {"uint32", VoxelType::uint32},
                                                         {"uint32_t", VoxelType::uint32},
                                                         {"uint", VoxelType::uint32},
                                                         {"unsigned int", VoxelType::uint32},
                                                         {"float", VoxelType::float32},
                                                         {"double", VoxelType::float64}};
  const auto found = known.find(lower_case(text));
  if (found == known.end()) throw InputError(file, "type", "\"" + text + "\" is not read");
  return found->second;
}

/// "(0.9,0,0)".
Eigen::Vector3d vector_in(std::string text, const fs::path& file, const std::string& item) {
  if (text.size() < 2 || text.front() != '(' || text.back() != ')')
    throw InputError(file, item,
                     "\"" + text.substr(0, 60) + "\" is not a vector such as (0.5,0,0)");
  std::istringstream words(text.substr(1, text.size() - 2));
  Eigen::Vector3d vector;
  std::string word;
  for (int a = 0; a < 3; ++a) {
    if (!std::getline(words, word, ','))
      throw InputError(file, item, "\"" + text.substr(0, 60) + "\" has fewer than 3 numbers");
    vector[a] = number_in(trimmed(word), file, item);
  }
  if (std::getline(words, word))
    throw InputError(file, item, "\"" + text.substr(0, 60) + "\" has more than 3 numbers");
  return vector;
}

/// Signs of the file's axes in LPS.
Eigen::Vector3d to_lps(const std::string& space, const fs::path& file) {
  const std::string name = lower_case(space);
  if (name == "left-posterior-superior" || name == "lps") return {1, 1, 1};
  if (name == "right-anterior-superior" || name == "ras") return {-1, -1, 1};
  if (name == "left-anterior-superior" || name == "las") return {1, -1, 1};
  throw InputError(file, "space",
                   "\"" + space +
                       "\" is not read; it must be left-posterior-superior, "
                       "right-anterior-superior or left-anterior-superior");
}

void read_geometry(const HeaderFields& fields, const fs::path& file, Volume& volume) {
  const Eigen::Vector3d sense = to_lps(required(fields, {"space"}, "space", file), file);
  // By definition lengths have the unit that is stated here.
  if (const auto units = fields.find("spaceunits");
      units != fields.end() && units->second != R"("mm" "mm" "mm")")
    throw InputError(file, "space units",
                     units->second.substr(0, 60) + " is not read; it must be \"mm\" \"mm\" \"mm\"");
  std::istringstream words(required(fields, {"spacedirections"}, "space directions", file));
  Eigen::Matrix3d steps;
  std::string word;
  for (int a = 0; a < 3; ++a) {
    // Blanks may follow the commas.
    std::string vector;
    while (vector.find(')') == std::string::npos && words >> word) {
      vector += (vector.empty() ? "" : " ") + word;
      if (vector == "none") throw InputError(file, "space directions", "an axis has none");
    }
    steps.col(a) = sense.cwiseProduct(vector_in(vector, file, "space directions"));
  }
  if (words >> word) throw InputError(file, "space directions", "has more than 3 vectors");
  const std::string& origin = required(fields, {"spaceorigin"}, "space origin", file);
  set_geometry(volume, steps, sense.cwiseProduct(vector_in(origin, file, "space origin")), file,
               "space directions");
}

}  // namespace

Volume read_nrrd(const fs::path& file) {
  std::string content = read_file(file);
  std::size_t begin = 0;
  const HeaderFields fields = nrrd_fields(content, file, begin);
  if (const std::string& dimension = required(fields, {"dimension"}, "dimension", file);
      count_in(dimension, file, "dimension") != 3)
    throw InputError(file, "dimension", "is " + dimension + "; a volume has 3");
  Volume volume;
  volume.size = sizes_in(required(fields, {"sizes"}, "sizes", file), file, "sizes");
  VoxelCoding coding;
  coding.type = nrrd_type(required(fields, {"type"}, "type", file), file);
  if (bytes_of(coding.type) > 1) {
    const std::string endian = lower_case(required(fields, {"endian"}, "endian", file));
    if (endian != "little" && endian != "big")
      throw InputError(file, "endian", "\"" + endian + "\" is neither little nor big");
    coding.big_endian = endian == "big";
  }
  for (const char* skip : {"lineskip", "byteskip"})
    if (const auto found = fields.find(skip); found != fields.end() && found->second != "0")
      throw InputError(file, skip, "\"" + found->second + "\": skipped data is not read");
  read_geometry(fields, file, volume);
  const std::size_t promised = byte_count(volume.size, coding.type, file);
  const std::string encoding = lower_case(required(fields, {"encoding"}, "encoding", file));
  if (encoding != "raw" && encoding != "gzip" && encoding != "gz")
    throw InputError(file, "encoding", "\"" + encoding + "\" is not read; raw and gzip are");
  fs::path source = file;
  for (const char* name : {"datafile", "detacheddatafile"})
    if (const auto found = fields.find(name); found != fields.end()) {
      source = data_file_beside(file, found->second);
      content = read_file(source);
      begin = 0;
    }
  const std::string_view data = std::string_view(content).substr(begin);
  if (encoding == "raw") {
    check_length(data.size(), promised, source);
    volume.values = decoded(data, coding);
  } else {
    volume.values = decoded(unpack(data, promised, source), coding);
  }
  return volume;
}

}  // namespace condyle
