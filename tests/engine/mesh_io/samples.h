#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "tests/engine/mesh/shapes.h"

namespace condyle::test {

/// A folder for this test, removed with the object.
class TempFolder {
 public:
  TempFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "condyle-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

template <class T>
void put(std::string& out, T value, bool big = false) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (big) std::reverse(bytes, bytes + sizeof(T));
  out.append(bytes, sizeof(T));
}

inline std::string ply_header(const std::string& format, std::size_t vertices, std::size_t faces) {
  return fmt::format(
      "ply\nformat {} 1.0\ncomment made by a test\nelement vertex {}\nproperty float x\n"
      "property float y\nproperty float z\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      format, vertices, faces);
}

inline std::string ascii_ply(const TriMesh& mesh) {
  std::string out = ply_header("ascii", mesh.vertices.size(), mesh.triangles.size());
  for (const auto& v : mesh.vertices)
    out += fmt::format("{} {} {}\n", static_cast<float>(v.x()), static_cast<float>(v.y()),
                       static_cast<float>(v.z()));
  for (const auto& t : mesh.triangles) out += fmt::format("3 {} {} {}\n", t[0], t[1], t[2]);
  return out;
}

inline std::string binary_ply(const TriMesh& mesh, bool big) {
  std::string out = ply_header(big ? "binary_big_endian" : "binary_little_endian",
                               mesh.vertices.size(), mesh.triangles.size());
  for (const auto& v : mesh.vertices)
    for (int k = 0; k < 3; ++k) put(out, static_cast<float>(v[k]), big);
  for (const auto& t : mesh.triangles) {
    put(out, std::uint8_t{3});
    for (int k = 0; k < 3; ++k) put(out, static_cast<std::int32_t>(t[k]), big);
  }
  return out;
}

inline std::string ascii_stl(const TriMesh& mesh) {
  std::string out = "solid sample\n";
  for (const auto& t : mesh.triangles) {
    out += "  facet normal 0 0 0\n    outer loop\n";
    for (int k = 0; k < 3; ++k) {
      const auto& v = mesh.vertices[t[k]];
      out += fmt::format("      vertex {} {} {}\n", v.x(), v.y(), v.z());
    }
    out += "    endloop\n  endfacet\n";
  }
  return out + "endsolid sample\n";
}

inline std::string binary_stl(const TriMesh& mesh) {
  std::string out(80, ' ');
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) put(out, 0.0f);
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k) put(out, static_cast<float>(mesh.vertices[t[c]][k]));
    put(out, std::uint16_t{0});
  }
  return out;
}

inline std::string obj(const TriMesh& mesh) {
  std::string out = "# sample\no thing\n";
  for (const auto& v : mesh.vertices) out += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  for (const auto& t : mesh.triangles)
    out += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return out;
}

/// A GLB file of a JSON text and a binary chunk.
inline std::string glb(std::string json, std::string bytes) {
  while (json.size() % 4) json += ' ';
  while (bytes.size() % 4) bytes += '\0';
  std::string out = "glTF";
  put(out, std::uint32_t{2});
  put(out, static_cast<std::uint32_t>(28 + json.size() + bytes.size()));
  put(out, static_cast<std::uint32_t>(json.size()));
  put(out, std::uint32_t{0x4E4F534A});
  out += json;
  put(out, static_cast<std::uint32_t>(bytes.size()));
  put(out, std::uint32_t{0x004E4942});
  return out + bytes;
}

/// One mesh of one primitive; `nodes` and `scene_nodes` as JSON lists, `extra` more of the root.
inline std::string glb(const TriMesh& mesh, const std::string& nodes = "[{\"mesh\":0}]",
                       const std::string& scene_nodes = "[0]", const std::string& extra = "") {
  std::string bytes;
  for (const auto& v : mesh.vertices)
    for (int k = 0; k < 3; ++k) put(bytes, static_cast<float>(v[k]));
  const std::size_t places = bytes.size();
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) put(bytes, static_cast<std::uint32_t>(t[k]));
  const std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":{}}}],"nodes":{},)"
      R"("meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],)"
      R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}},)"
      R"({{"bufferView":1,"componentType":5125,"count":{},"type":"SCALAR"}}],)"
      R"("bufferViews":[{{"buffer":0,"byteLength":{}}},{{"buffer":0,"byteOffset":{},"byteLength":{}}}],)"
      R"("buffers":[{{"byteLength":{}}}]{}}})",
      scene_nodes, nodes, mesh.vertices.size(), 3 * mesh.triangles.size(), places, places,
      bytes.size() - places, bytes.size(), extra);
  return glb(json, bytes);
}

/// Every coordinate as a single-precision file holds it.
inline TriMesh single_precision(TriMesh mesh) {
  for (auto& v : mesh.vertices)
    for (int k = 0; k < 3; ++k) {
      // Through memory: g++ 12 at -O2 drops the rounding of two neighbours it vectorises.
      volatile float rounded = static_cast<float>(v[k]);
      v[k] = rounded;
    }
  return mesh;
}

}  // namespace condyle::test
