#include "engine/cut/part_faces.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "engine/cut/cap_loops.h"
#include "engine/cut/fill_loops.h"

namespace condyle {
namespace {

constexpr int several = -3;  // parts

/// By triangle of the mesh: the part of all its fragments, or `several`.
struct Sources {
  std::vector<int> part;
  std::vector<std::vector<int>> fragments;  // faces
};

Sources find_sources(const CellComplex& complex, const JoinedCells& joined, std::size_t triangles) {
  Sources sources{std::vector<int>(triangles, -2), std::vector<std::vector<int>>(triangles)};
  for (std::size_t i = 0; i < complex.faces().size(); ++i) {
    const CellFace& face = complex.faces()[i];
    if (face.source < 0) continue;
    const int part = joined.of_face[i][1];
    int& whole = sources.part[face.source];
    whole = whole == -2 || whole == part ? part : several;
    sources.fragments[face.source].push_back(static_cast<int>(i));
  }
  return sources;
}

/// Appends a triangle of the mesh with the kept vertices on its edges.
void add_whole(const CellComplex& complex, const Eigen::Vector3i& triangle, int source,
               const std::vector<int>& fragments, const std::vector<char>& kept,
               std::vector<PartFace>& faces) {
  const std::array<int, 3> corners{triangle[0], triangle[1], triangle[2]};
  CapEdges outline;
  for (const int i : fragments) {
    const auto& v = complex.faces()[i].vertices;
    for (int k = 0; k < 3; ++k) outline.add(v[k], v[(k + 1) % 3]);
  }
  // The outline, from its first corner.
  std::map<int, int> next;
  for (const auto& [from, to] : outline.remaining()) next[from] = to;
  std::vector<int> ring;
  int at = corners[0];
  do {
    if (kept[at]) ring.push_back(at);
    const auto step = next.find(at);
    if (step == next.end()) break;
    at = step->second;
  } while (at != corners[0] && ring.size() <= next.size());
  if (ring.size() <= 3) {
    faces.push_back({corners, source, -1});
    return;
  }
  const auto& p = complex.vertices();
  const Eigen::Vector3d normal =
      (p[corners[1]] - p[corners[0]]).cross(p[corners[2]] - p[corners[0]]);
  const Eigen::Vector3d right = (p[corners[1]] - p[corners[0]]).normalized(),
                        up = normal.cross(right).normalized();
  std::vector<Eigen::Vector2d> points;
  std::vector<int> loop;
  for (const int v : ring) {
    loop.push_back(static_cast<int>(points.size()));
    points.push_back({right.dot(p[v] - p[corners[0]]), up.dot(p[v] - p[corners[0]])});
  }
  for (const auto& t : fill_loops(points, {loop}).triangles)
    faces.push_back({{ring[t[0]], ring[t[1]], ring[t[2]]}, source, -1});
}

}  // namespace

std::vector<std::vector<PartFace>> part_faces(const CellComplex& complex, const JoinedCells& joined,
                                              const TriMesh& mesh) {
  const Sources sources = find_sources(complex, joined, mesh.triangles.size());
  const auto is_whole = [&](int source) { return source >= 0 && sources.part[source] >= 0; };
  std::vector<char> kept(complex.vertices().size(), false);
  std::fill_n(kept.begin(), mesh.vertices.size(), true);
  for (std::size_t i = 0; i < complex.faces().size(); ++i) {
    const CellFace& face = complex.faces()[i];
    if (is_whole(face.source) || joined.of_face[i][0] == joined.of_face[i][1]) continue;
    for (const int v : face.vertices) kept[v] = true;
  }
  std::vector<std::vector<PartFace>> parts(joined.parts);
  for (std::size_t source = 0; source < mesh.triangles.size(); ++source)
    if (is_whole(static_cast<int>(source)))
      add_whole(complex, mesh.triangles[source], static_cast<int>(source),
                sources.fragments[source], kept, parts[sources.part[source]]);
  for (std::size_t i = 0; i < complex.faces().size(); ++i) {
    const CellFace& face = complex.faces()[i];
    const auto [front, back] = joined.of_face[i];
    if (is_whole(face.source) || front == back) continue;
    if (back >= 0) parts[back].push_back({face.vertices, face.source, face.wall});
    if (front >= 0)
      parts[front].push_back(
          {{face.vertices[2], face.vertices[1], face.vertices[0]}, face.source, face.wall});
  }
  return parts;
}

}  // namespace condyle
