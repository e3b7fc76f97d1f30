#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/core/error.h"
#include "engine/mesh_io/line_reader.h"
#include "engine/mesh_io/mesh_files.h"
#include "engine/mesh_io/polygon.h"
#include "engine/mesh_io/readers.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

/// Keywords that do not affect the surface.
constexpr std::array<std::string_view, 22> ignored = {
    "vt",     "vn",         "vp",        "g",   "o",      "s",     "mg",       "usemtl",
    "mtllib", "usemap",     "maplib",    "l",   "p",      "bevel", "c_interp", "d_interp",
    "lod",    "shadow_obj", "trace_obj", "deg", "cstype", "end"};

class ObjReader {
 public:
  ObjReader(const fs::path& file, std::string_view content) : file_(file), lines_(content) {}

  TriMesh read() {
    while (lines_.next()) {
      const std::string_view key = lines_.word();
      if (key.empty() || key.front() == '#') continue;
      if (key == "v") {
        read_vertex();
      } else if (key == "f" || key == "fo") {
        read_face();
      } else if (std::find(ignored.begin(), ignored.end(), key) != ignored.end()) {
        while (continues()) lines_.next();
      } else {
        refuse("the word " + in_quotes(key) + " is not known in an OBJ file of polygons");
      }
    }
    return finish();
  }

 private:
  struct Face {
    long line;
    std::size_t end;  // of its corners
  };

  [[noreturn]] void refuse(const std::string& problem) const {
    throw InputError(file_, lines_.where(), problem);
  }
  bool continues() const { return !lines_.line().empty() && lines_.line().back() == '\\'; }

  /// Next word of the statement, across lines that end in a backslash.
  std::string_view word() {
    while (true) {
      const std::string_view found = lines_.word();
      if (found != "\\") return found;
      if (!lines_.next()) return {};
    }
  }

  void read_vertex() {
    std::array<double, 7> numbers{};
    std::size_t count = 0;
    for (std::string_view w = word(); !w.empty(); w = word()) {
      const auto number = to_number<double>(w);
      if (!number) refuse("the vertex has " + in_quotes(w) + " where a number should be");
      if (count == numbers.size()) refuse("the vertex has more than 7 numbers");
      numbers[count++] = *number;
    }
    if (count < 3) refuse(fmt::format("the vertex has {} numbers; 3 are needed", count));
    const Eigen::Vector3d v(numbers[0], numbers[1], numbers[2]);
    if (!sound_point(v))
      refuse_point(file_, fmt::format("{}, vertex {}", lines_.where(), mesh_.vertices.size() + 1),
                   v);
    mesh_.vertices.push_back(v);
    check_count(file_, "vertices", static_cast<double>(mesh_.vertices.size()), max_mesh_vertices);
    // Six or seven numbers: the last three are a colour (a seventh, the fourth, is a weight).
    if (count < 6) return;
    const Eigen::Vector3f color(static_cast<float>(numbers[count - 3]),
                                static_cast<float>(numbers[count - 2]),
                                static_cast<float>(numbers[count - 1]));
    if (!((color.array() >= 0).all() && (color.array() <= 1).all()))
      refuse("the vertex has a colour outside 0 to 1");
    mesh_.colors.push_back(color);
  }

  void read_face() {
    const std::size_t before = corners_.size();
    for (std::string_view w = word(); !w.empty(); w = word()) {
      const std::string_view digits = w.substr(0, w.find('/'));
      const auto index = to_number<long>(digits);
      if (!index || *index == 0)
        refuse("the face has " + in_quotes(w) +
               " where a vertex number (1, 2 ... or -1, -2 ...) should be");
      // Negative numbers count back from the newest vertex.
      const long vertex =
          *index > 0 ? *index - 1 : static_cast<long>(mesh_.vertices.size()) + *index;
      if (vertex < 0 || vertex >= max_mesh_vertices)
        refuse(fmt::format("the face speaks of vertex {}, but there are {} so far", *index,
                           mesh_.vertices.size()));
      corners_.push_back(static_cast<int>(vertex));
    }
    const std::size_t count = corners_.size() - before;
    if (count < 3 || count > max_polygon_corners)
      refuse(
          fmt::format("the face has {} corners; 3 to {} are possible", count, max_polygon_corners));
    triangles_ += count - 2;
    check_count(file_, "triangles", static_cast<double>(triangles_), max_mesh_triangles);
    faces_.push_back({lines_.number(), corners_.size()});
  }

  /// Faces may precede their vertices: they are checked and triangulated when all have been read.
  TriMesh finish() {
    const auto count = static_cast<int>(mesh_.vertices.size());
    if (mesh_.colors.size() != mesh_.vertices.size()) mesh_.colors.clear();
    mesh_.triangles.reserve(triangles_);
    std::size_t first = 0;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const auto corners = std::span<const int>(corners_).subspan(first, faces_[f].end - first);
      for (const int c : corners)
        if (c >= count)
          throw InputError(file_, fmt::format("line {}, face {}", faces_[f].line, f + 1),
                           fmt::format("speaks of vertex {}, but there are {}", c + 1, count));
      triangulate(corners, mesh_.vertices, mesh_.triangles);
      first = faces_[f].end;
    }
    return std::move(mesh_);
  }

  const fs::path& file_;
  LineReader lines_;
  TriMesh mesh_;
  std::vector<int> corners_;
  std::vector<Face> faces_;
  std::size_t triangles_ = 0;
};

}  // namespace

TriMesh read_obj(const fs::path& file, std::string_view content) {
  const std::string kind = looks_like(content);
  if (kind != "an OBJ file" && kind != "some text")
    throw InputError(file, "",
                     "is not an OBJ file (it begins like " + kind +
                         "); give it the right extension, or export it as OBJ");
  return ObjReader(file, content).read();
}

}  // namespace condyle
