#include <fmt/format.h>

#include <bit>

#include "engine/core/files.h"
#include "engine/volume/unpack.h"
#include "engine/volume/volume_files.h"

namespace condyle {
namespace {

std::string nrrd_vector(const Eigen::Vector3d& v) {
  return fmt::format("({},{},{})", v.x(), v.y(), v.z());  // the shortest text that reads back
}

}  // namespace

void write_nrrd(const Volume& volume, const std::filesystem::path& file, NrrdEncoding encoding) {
  static_assert(std::endian::native == std::endian::little);
  std::string directions;
  for (int a = 0; a < 3; ++a)
    directions += (a > 0 ? " " : "") + nrrd_vector(volume.axes.col(a) * volume.spacing_mm[a]);
  std::string content = fmt::format(
      "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\n"
      "sizes: {} {} {}\nspace directions: {}\nkinds: domain domain domain\nendian: little\n"
      "encoding: {}\nspace origin: {}\n\n",
      volume.size[0], volume.size[1], volume.size[2], directions,
      encoding == NrrdEncoding::gzip ? "gzip" : "raw", nrrd_vector(volume.origin));
  const std::string_view bytes(reinterpret_cast<const char*>(volume.values.data()),
                               volume.values.size() * sizeof(volume.values[0]));
  if (encoding == NrrdEncoding::gzip)
    append_gzip(content, bytes);
  else
    content += bytes;
  write_file(file, content);
}

}  // namespace condyle
