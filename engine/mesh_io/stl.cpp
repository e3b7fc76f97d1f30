#include <fmt/format.h>

#include <cstring>

#include "engine/core/error.h"
#include "engine/mesh/repair.h"
#include "engine/mesh_io/line_reader.h"
#include "engine/mesh_io/mesh_files.h"
#include "engine/mesh_io/readers.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

/// Welds while reading, so that only a part of the corners is unwelded in memory.
class Soup {
 public:
  explicit Soup(std::size_t triangles) {
    mesh_.vertices.reserve(std::min<std::size_t>(3 * triangles, 3'000'000));
    mesh_.triangles.reserve(triangles);
  }
  void add(const Vector3d& v) {
    mesh_.vertices.push_back(v);
    if (++corners_ % 3 != 0) return;
    const int last = static_cast<int>(mesh_.vertices.size());
    mesh_.triangles.emplace_back(last - 3, last - 2, last - 1);
    if (mesh_.vertices.size() < next_weld_) return;
    weld(mesh_);
    next_weld_ = 2 * mesh_.vertices.size() + 3'000'000;
  }
  std::size_t triangles() const { return mesh_.triangles.size(); }
  TriMesh take() {
    weld(mesh_);
    return std::move(mesh_);
  }

 private:
  TriMesh mesh_;
  std::size_t corners_ = 0, next_weld_ = 3'000'000;
};

TriMesh read_binary(const fs::path& file, std::string_view content) {
  std::uint32_t count = 0;
  std::memcpy(&count, content.data() + 80, 4);
  const std::uint64_t expected = 84 + 50 * static_cast<std::uint64_t>(count);
  if (count == 0)
    throw InputError(file, "header", "promises 0 triangles; export the surface again");
  if (expected != content.size())
    throw InputError(file, "header",
                     fmt::format("states {} triangles, which need {} bytes, but the file has {}: "
                                 "it is {}; export or copy it again",
                                 count, expected, content.size(),
                                 expected > content.size() ? "cut short or damaged" : "damaged"));
  check_count(file, "triangles", count, max_mesh_triangles);
  Soup soup(count);
  const char* at = content.data() + 84;
  for (std::uint32_t i = 0; i < count; ++i, at += 50) {
    float values[9];
    std::memcpy(values, at + 12, sizeof values);
    for (int k = 0; k < 3; ++k) {
      const Vector3d v(values[3 * k], values[3 * k + 1], values[3 * k + 2]);
      if (!sound_point(v)) refuse_point(file, fmt::format("triangle {}, corner {}", i, k), v);
      soup.add(v);
    }
  }
  return soup.take();
}

TriMesh read_ascii(const fs::path& file, std::string_view content) {
  LineReader lines(content);
  const auto refuse = [&](const std::string& problem) {
    throw InputError(file, lines.where(), problem + "; export the surface again");
  };
  Soup soup(content.size() / 250);
  // The lines of each facet must follow in this order; a file may have several solids.
  enum class Step { solid, facet, loop, corners, end_facet } step = Step::solid;
  int corner = 0;
  while (lines.next()) {
    const std::string_view key = lines.word();
    if (key.empty()) continue;
    if (step == Step::solid && key == "solid") {
      step = Step::facet;
    } else if (step == Step::facet && key == "facet") {
      step = Step::loop;
    } else if (step == Step::facet && key == "endsolid") {
      step = Step::solid;
    } else if (step == Step::loop && key == "outer") {
      step = Step::corners;
      corner = 0;
    } else if (step == Step::corners && key == "vertex") {
      if (corner == 3) refuse("the facet has more than 3 corners");
      Vector3d v;
      for (int k = 0; k < 3; ++k) {
        const std::string_view word = lines.word();
        const auto number = to_number<double>(word);
        if (!number) refuse("the corner has " + in_quotes(word) + " where a number should be");
        v[k] = *number;
      }
      if (!lines.word().empty()) refuse("the corner has more than 3 numbers");
      if (!sound_point(v)) refuse_point(file, lines.where(), v);
      soup.add(v);
      ++corner;
    } else if (step == Step::corners && key == "endloop") {
      if (corner != 3) refuse(fmt::format("the facet has {} corners; 3 are needed", corner));
      step = Step::end_facet;
    } else if (step == Step::end_facet && key == "endfacet") {
      step = Step::facet;
      check_count(file, "triangles", static_cast<double>(soup.triangles()), max_mesh_triangles);
    } else {
      refuse("the word " + in_quotes(key) + " does not belong here");
    }
  }
  if (step != Step::solid)
    throw InputError(
        file, lines.where(),
        "the file ends without \"endsolid\": it is cut short; export or copy it again");
  return soup.take();
}

}  // namespace

TriMesh read_stl(const fs::path& file, std::string_view content) {
  std::uint64_t promised = 0;
  if (content.size() >= 84) {
    std::uint32_t count = 0;
    std::memcpy(&count, content.data() + 80, 4);
    promised = 84 + 50 * static_cast<std::uint64_t>(count);
  }
  // Many binary files begin with "solid" too: the size decides first.
  if (promised == content.size() && promised > 84) return read_binary(file, content);
  const std::string kind = looks_like(content);
  if (kind == "an ASCII STL file" || (content.substr(0, 5) == "solid" && kind == "some text"))
    return read_ascii(file, content);
  if (content.size() < 84)
    throw InputError(
        file, "header",
        fmt::format("the file has {} bytes; a binary STL file has 84 or more: it is cut "
                    "short, or no STL file (it begins like {})",
                    content.size(), kind));
  if (kind != "some binary file" && kind != "a binary STL file")
    throw InputError(file, "",
                     "is not an STL file (it begins like " + kind +
                         "); give it the right extension, or export it as STL");
  return read_binary(file, content);
}

}  // namespace condyle
