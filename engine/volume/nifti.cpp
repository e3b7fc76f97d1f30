#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/volume/unpack.h"
#include "engine/volume/volume_readers.h"
#include "engine/volume/voxel_data.h"

// source: nifti1.h, nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h

namespace condyle {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t header_bytes = 348;

/// Fields of the header by their places.
class Header {
 public:
  Header(std::string bytes, const fs::path& file) : bytes_(std::move(bytes)) {
    if (bytes_.size() < header_bytes || bytes_.compare(344, 4, std::string_view("n+1\0", 4)) != 0)
      throw InputError(file, "", "has no header of NIfTI-1 with its data in the same file");
    swaps_ = number<std::int32_t>(0) != header_bytes;
    if (number<std::int32_t>(0) != header_bytes) throw InputError(file, "sizeof_hdr", "is not 348");
  }
  template <class Number>
  Number number(std::size_t at) const {
    char one[sizeof(Number)];
    std::memcpy(one, bytes_.data() + at, sizeof(Number));
    if (swaps_) std::reverse(one, one + sizeof(Number));
    Number value;
    std::memcpy(&value, one, sizeof(Number));
    return value;
  }
  double real(std::size_t at) const { return number<float>(at); }
  int whole(std::size_t at) const { return number<std::int16_t>(at); }
  bool big_endian() const { return swaps_ != (std::endian::native == std::endian::big); }

 private:
  std::string bytes_;
  bool swaps_ = false;
};

VoxelType nifti_type(int datatype, const fs::path& file) {
  switch (datatype) {
    case 2:
      return VoxelType::uint8;
    case 4:
      return VoxelType::int16;
    case 8:
      return VoxelType::int32;
    case 16:
      return VoxelType::float32;
    case 64:
      return VoxelType::float64;
    case 256:
      return VoxelType::int8;
    case 512:
      return VoxelType::uint16;
    case 768:
      return VoxelType::uint32;
    default:
      throw InputError(file, "datatype", std::to_string(datatype) + " is not read");
  }
}

/// Millimetres of the unit in which lengths are stated.
double unit_mm(int units, const fs::path& file) {
  switch (units & 7) {
    case 0:  // not stated; millimetres by convention
    case 2:
      return 1;
    case 1:
      return 1000;
    case 3:
      return 1e-3;
    default:
      throw InputError(file, "xyzt_units", std::to_string(units) + " names no unit of length");
  }
}

/// Steps and origin in RAS.
struct Lattice {
  Eigen::Matrix3d steps;
  Eigen::Vector3d origin;
};

Lattice by_rows(const Header& header) {
  Lattice lattice;
  for (int r = 0; r < 3; ++r) {
    const std::size_t row = 280 + 16 * static_cast<std::size_t>(r);
    for (int a = 0; a < 3; ++a)
      lattice.steps(r, a) = header.real(row + 4 * static_cast<std::size_t>(a));
    lattice.origin[r] = header.real(row + 12);
  }
  return lattice;
}

Lattice by_quaternion(const Header& header, const fs::path& file) {
  const Eigen::Vector3d v(header.real(256), header.real(260), header.real(264));
  const double rest = 1 - v.squaredNorm();
  if (!(rest > -1e-5)) throw InputError(file, "quatern", "is not a rotation");
  // Below that it is rounding of a half turn, as in the source.
  const double w = rest < 1e-7 ? 0 : std::sqrt(rest);
  const Eigen::Quaterniond turn = Eigen::Quaterniond(w, v.x(), v.y(), v.z()).normalized();
  for (const std::size_t at : {80, 84, 88})
    if (!(header.real(at) > 0)) throw InputError(file, "pixdim", "is not positive along each axis");
  const double sense = header.real(76) < 0 ? -1 : 1;
  Lattice lattice;
  lattice.steps = turn.toRotationMatrix();
  for (int a = 0; a < 3; ++a)
    lattice.steps.col(a) *=
        header.real(80 + 4 * static_cast<std::size_t>(a)) * (a == 2 ? sense : 1);
  lattice.origin = {header.real(268), header.real(272), header.real(276)};
  return lattice;
}

}  // namespace

Volume read_nifti(const fs::path& file) {
  std::string content = read_file(file);
  const bool packed = content.starts_with("\x1f\x8b");
  const Header header(
      packed ? unpack_start(content, header_bytes, file) : content.substr(0, header_bytes), file);
  // Further dimensions, such as time, have a size of 1.
  const int dimensions = header.whole(40);
  if (dimensions < 3 || dimensions > 7)
    throw InputError(file, "dim", "it states " + std::to_string(dimensions) + " dimensions");
  for (int d = 4; d <= dimensions; ++d)
    if (header.whole(40 + 2 * static_cast<std::size_t>(d)) != 1)
      throw InputError(file, "dim", "it holds several volumes");
  Volume volume;
  for (std::size_t a = 0; a < 3; ++a) volume.size[a] = header.whole(42 + 2 * a);
  VoxelCoding coding{nifti_type(header.whole(70), file), header.big_endian()};
  const double slope = header.real(112), intercept = header.real(116);
  if (slope != 0) {  // 0: values are as stored
    if (!std::isfinite(slope) || !std::isfinite(intercept))
      throw InputError(file, "scl_slope", "a number is not finite");
    coding.slope = slope;
    coding.intercept = intercept;
  }
  // Codes above 2 are positions in a template, whose size is not the patient's.
  const auto of_patient = [&](std::size_t code) {
    return header.whole(code) == 1 || header.whole(code) == 2;
  };
  const bool rows = of_patient(254);
  if (!rows && !of_patient(252))
    throw InputError(file, "sform_code, qform_code",
                     header.whole(254) > 2 || header.whole(252) > 2
                         ? "the volume is aligned to a template, not to the patient"
                         : "neither is set, so that the directions of the axes are unknown");
  const Lattice lattice = rows ? by_rows(header) : by_quaternion(header, file);
  const double unit = unit_mm(header.number<std::uint8_t>(123), file);
  const Eigen::Vector3d to_lps(-unit, -unit, unit);
  set_geometry(volume, to_lps.asDiagonal() * lattice.steps, to_lps.cwiseProduct(lattice.origin),
               file, rows ? "srow" : "pixdim");

  const std::size_t promised = byte_count(volume.size, coding.type, file);
  const double offset = header.real(108);
  if (!(offset >= static_cast<double>(header_bytes) && offset < 1e6))
    throw InputError(file, "vox_offset", "is not between 348 and 1000000");
  const auto begin = static_cast<std::size_t>(offset);
  if (packed) content = unpack(content, begin + promised, file);
  check_length(content.size() < begin ? 0 : content.size() - begin, promised, file);
  volume.values = decoded(std::string_view(content).substr(begin), coding);
  return volume;
}

}  // namespace condyle
