#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "engine/core/files.h"
#include "engine/mesh_io/mesh_files.h"

namespace condyle {
namespace {

template <class T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::uint8_t byte_of(float c) { return static_cast<std::uint8_t>(std::lround(255.0f * c)); }

/// Whether bytes store the colours without loss, as when they came from a picture.
bool fits_bytes(const TriMesh& mesh) {
  for (const auto& color : mesh.colors)
    for (int k = 0; k < 3; ++k)
      if (!(color[k] >= 0 && color[k] <= 1) ||
          static_cast<float>(byte_of(color[k]) / 255.0) != color[k])
        return false;
  return true;
}

}  // namespace

void write_ply(const TriMesh& mesh, const std::filesystem::path& file) {
  write_ply(mesh, "", {}, file);
}

void write_ply(const TriMesh& mesh, const std::string& property, std::span<const float> values,
               const std::filesystem::path& file) {
  assert(values.empty() || values.size() == mesh.vertices.size());
  const bool colored = !mesh.colors.empty();
  const bool bytes = fits_bytes(mesh);
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment millimetres\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n",
      mesh.vertices.size());
  if (colored)
    for (const char* name : {"red", "green", "blue"})
      out += fmt::format("property {} {}\n", bytes ? "uchar" : "float", name);
  if (!values.empty()) out += fmt::format("property float {}\n", property);
  out += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                     mesh.triangles.size());
  out.reserve(out.size() + mesh.vertices.size() * 40 + mesh.triangles.size() * 13);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (int k = 0; k < 3; ++k) put(out, mesh.vertices[i][k]);
    for (int k = 0; colored && k < 3; ++k) {
      if (bytes)
        put(out, byte_of(mesh.colors[i][k]));
      else
        put(out, mesh.colors[i][k]);
    }
    if (!values.empty()) put(out, values[i]);
  }
  for (const auto& t : mesh.triangles) {
    put(out, std::uint8_t{3});
    for (int k = 0; k < 3; ++k) put(out, static_cast<std::int32_t>(t[k]));
  }
  write_file(file, out);
}

void write_stl(const TriMesh& mesh, const std::filesystem::path& file) {
  std::string out = "binary STL, millimetres";
  out.resize(80, ' ');
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const auto &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    Eigen::Vector3d normal = (b - a).cross(c - a);
    if (normal.norm() > 0) normal.normalize();
    for (const auto* v : {&std::as_const(normal), &a, &b, &c})
      for (int k = 0; k < 3; ++k) put(out, static_cast<float>((*v)[k]));
    put(out, std::uint16_t{0});
  }
  write_file(file, out);
}

}  // namespace condyle
