#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <new>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/mesh_io/line_reader.h"
#include "engine/mesh_io/mesh_files.h"
#include "engine/mesh_io/readers.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_bytes = std::size_t{1} << 30;

using Reader = TriMesh (*)(const fs::path&, std::string_view);

Reader reader_for(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".stl") return read_stl;
  if (extension == ".ply") return read_ply;
  if (extension == ".obj") return read_obj;
  if (extension == ".glb") return read_glb;
  if (extension == ".gltf")
    throw InputError(file, "", "glTF in several files is not read; save it as one .glb file");
  throw InputError(file, "",
                   (extension.empty() ? std::string("has no extension")
                                      : "the extension " + in_quotes(extension) + " is not known") +
                       "; surfaces are read from .stl, .ply, .obj and .glb files");
}

void check_result(const fs::path& file, const TriMesh& mesh) {
  if (mesh.triangles.empty())
    throw InputError(file, "",
                     fmt::format("has no triangles ({} vertices); a surface is needed, "
                                 "not a point cloud or lines",
                                 mesh.vertices.size()));
  const int count = static_cast<int>(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (const int index = mesh.triangles[i][k]; index < 0 || index >= count)
        throw InputError(file, fmt::format("triangle {}", i),
                         fmt::format("speaks of vertex {}, but there are {}", index, count));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!sound_point(mesh.vertices[i]))
      refuse_point(file, fmt::format("vertex {} (counted from 0)", i), mesh.vertices[i]);
}

}  // namespace

TriMesh read_mesh(const fs::path& file) {
  if (std::error_code error; fs::is_directory(file, error))
    throw InputError(file, "", "is a folder; name one .stl, .ply, .obj or .glb file");
  if (std::error_code error; !fs::exists(file, error)) throw InputError(file, "", "no such file");
  reader_for(file);  // a wrong extension is reported before a large file is read
  try {
    return parse_mesh(file, read_file(file, max_bytes));
  } catch (const std::bad_alloc&) {
    throw MachineError(file.string() + ": there is not enough memory to read it");
  }
}

TriMesh parse_mesh(const fs::path& file, std::string_view content) {
  const Reader reader = reader_for(file);
  if (content.empty()) throw InputError(file, "", "is empty (0 bytes); export it again");
  TriMesh mesh = reader(file, content);
  check_result(file, mesh);
  return mesh;
}

std::string looks_like(std::string_view content) {
  const auto starts = [&](std::string_view s) { return content.substr(0, s.size()) == s; };
  if (starts("ply\n") || starts("ply\r")) return "a PLY file";
  if (starts("glTF")) return "a GLB file";
  if (starts("PK\3\4")) return "a ZIP archive";
  if (starts("\x1f\x8b")) return "a gzip archive";
  if (starts("\x89PNG") || starts("\xff\xd8\xff")) return "a picture";
  if (starts("<?xml") || starts("<")) return "XML or HTML";
  if (starts("# vtk")) return "a VTK file";
  if (starts("{")) return "JSON";
  if (starts("OFF")) return "an OFF file";
  if (starts("version https://git-lfs")) return "a Git LFS pointer: the real file was not fetched";
  if (starts("solid") && content.substr(0, 2000).find("facet") != std::string_view::npos)
    return "an ASCII STL file";
  const std::string_view head = content.substr(0, 4000);
  const auto binary = std::any_of(head.begin(), head.end(), [](unsigned char c) {
    return c == 0 || (c < 32 && c != '\n' && c != '\r' && c != '\t');
  });
  if (content.size() >= 84 && binary) {
    std::uint32_t count = 0;
    std::copy_n(content.data() + 80, 4, reinterpret_cast<char*>(&count));
    if (content.size() == 84 + 50 * static_cast<std::uint64_t>(count)) return "a binary STL file";
  }
  if (binary) return "some binary file";
  if (starts("v ") || head.find("\nv ") != std::string_view::npos) return "an OBJ file";
  return "some text";
}

void check_count(const fs::path& file, std::string_view what, double count, int limit) {
  if (count > limit)
    throw InputError(file, "header",
                     fmt::format("promises {:.0f} {}; at most {} are read: simplify the surface "
                                 "first, or the file is damaged",
                                 count, what, limit));
}

bool sound_point(const Eigen::Vector3d& p) {
  return (p.array().abs() <= 1e9).all();  // a head in micrometres reaches 3e5; false for NaN
}

void refuse_point(const fs::path& file, const std::string& item, const Eigen::Vector3d& p) {
  throw InputError(file, item,
                   fmt::format("its place is ({}, {}, {}); coordinates must be finite numbers "
                               "below 1e9: export the surface again",
                               p.x(), p.y(), p.z()));
}

std::string in_quotes(std::string_view word) {
  std::string text = "\"";
  for (const char c : word.substr(0, 40))
    text += std::isprint(static_cast<unsigned char>(c)) ? c : '?';
  return text + (word.size() > 40 ? "...\"" : "\"");
}

}  // namespace condyle
