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

/// New vertices that pieces need: corners of cut faces, and those where parts meet. Others lie on
/// an edge of the mesh that a plane divided where nothing was cut.
std::vector<char> kept_vertices(const CellComplex& complex, const JoinedCells& joined,
                                std::size_t of_mesh) {
  constexpr int none = -2;
  std::vector<char> kept(complex.vertices().size(), false);
  std::fill_n(kept.begin(), of_mesh, true);
  std::vector<int> part_at(kept.size(), none);
  for (std::size_t i = 0; i < complex.faces().size(); ++i) {
    const CellFace& face = complex.faces()[i];
    const auto [front, back] = joined.of_face[i];
    for (const int v : face.vertices) {
      if (face.source < 0) {
        if (front != back) kept[v] = true;
      } else if (part_at[v] == none) {
        part_at[v] = back;
      } else if (part_at[v] != back) {
        kept[v] = true;
      }
    }
  }
  return kept;
}

void add_outline(const CellFace& face, CapEdges& outline) {
  for (int k = 0; k < 3; ++k) outline.add(face.vertices[k], face.vertices[(k + 1) % 3]);
}

/// Makes triangles of the mesh from their fragments.
class Rebuilder {
 public:
  Rebuilder(const CellComplex& complex, const JoinedCells& joined, const TriMesh& mesh)
      : complex_(complex),
        joined_(joined),
        mesh_(mesh),
        kept_(kept_vertices(complex, joined, mesh.vertices.size())) {}

  /// Appends a triangle with the kept vertices on its edges.
  void add_whole(int source, const std::vector<int>& fragments, std::vector<PartFace>& faces) {
    const auto& t = mesh_.triangles[source];
    CapEdges outline;
    for (const int i : fragments) add_outline(complex_.faces()[i], outline);
    std::map<int, int> next;
    for (const auto& [from, to] : outline.remaining()) next[from] = to;
    std::vector<int> ring;
    int at = t[0];
    do {
      if (kept_[at]) ring.push_back(at);
      const auto step = next.find(at);
      if (step == next.end()) break;
      at = step->second;
    } while (at != t[0] && ring.size() <= next.size());
    if (ring.size() <= 3) {
      faces.push_back({{t[0], t[1], t[2]}, source, -1});
      return;
    }
    set_axes(source);
    CapLoops cap{std::move(ring), {}, {{}}};
    for (std::size_t i = 0; i < cap.vertices.size(); ++i) {
      cap.points.push_back(in_plane(cap.vertices[i]));
      cap.loops[0].push_back(static_cast<int>(i));
    }
    fill(cap, source, faces);
  }

  /// Appends what each part has of a triangle, without the vertices on its edges that no piece
  /// needs.
  void add_divided(int source, const std::vector<int>& fragments,
                   std::vector<std::vector<PartFace>>& parts) {
    CapEdges outline;
    for (const int i : fragments) add_outline(complex_.faces()[i], outline);
    std::vector<int> idle;
    for (const auto& [from, to] : outline.remaining())
      if (!kept_[from]) idle.push_back(from);
    std::map<int, CapEdges> by_part;
    for (const int i : fragments) {
      const int part = joined_.of_face[i][1];
      if (part < 0) continue;
      const CellFace& face = complex_.faces()[i];
      if (idle.empty())
        parts[part].push_back({face.vertices, source, -1});
      else
        add_outline(face, by_part[part]);
    }
    if (by_part.empty()) return;
    set_axes(source);
    for (const auto& [part, edges] : by_part) {
      CapLoops cap = find_cap_loops(edges, complex_.vertices(), right_, up_);
      for (auto& loop : cap.loops)
        std::erase_if(loop, [&](int at) {
          return std::binary_search(idle.begin(), idle.end(), cap.vertices[at]);
        });
      std::erase_if(cap.loops, [](const auto& loop) { return loop.size() < 3; });
      fill(cap, source, parts[part]);
    }
  }

 private:
  void set_axes(int source) {
    const auto& t = mesh_.triangles[source];
    const auto& p = complex_.vertices();
    const Eigen::Vector3d edge = p[t[1]] - p[t[0]];
    right_ = edge.normalized();
    up_ = edge.cross(p[t[2]] - p[t[0]]).cross(right_).normalized();
  }
  Eigen::Vector2d in_plane(int v) const {
    return {right_.dot(complex_.vertices()[v]), up_.dot(complex_.vertices()[v])};
  }
  static void fill(const CapLoops& cap, int source, std::vector<PartFace>& faces) {
    for (const auto& t : fill_loops(cap.points, cap.loops).triangles)
      faces.push_back({{cap.vertices[t[0]], cap.vertices[t[1]], cap.vertices[t[2]]}, source, -1});
  }

  const CellComplex& complex_;
  const JoinedCells& joined_;
  const TriMesh& mesh_;
  std::vector<char> kept_;
  Eigen::Vector3d right_, up_;  // of the triangle's plane
};

}  // namespace

std::vector<std::vector<PartFace>> part_faces(const CellComplex& complex, const JoinedCells& joined,
                                              const TriMesh& mesh) {
  const Sources sources = find_sources(complex, joined, mesh.triangles.size());
  std::vector<std::vector<PartFace>> parts(joined.parts);
  Rebuilder rebuilder(complex, joined, mesh);
  for (int source = 0; source < static_cast<int>(mesh.triangles.size()); ++source) {
    const auto& fragments = sources.fragments[source];
    if (const int part = sources.part[source]; part >= 0)
      rebuilder.add_whole(source, fragments, parts[part]);
    else if (part == several)
      rebuilder.add_divided(source, fragments, parts);
  }
  for (std::size_t i = 0; i < complex.faces().size(); ++i) {
    const CellFace& face = complex.faces()[i];
    const auto [front, back] = joined.of_face[i];
    if (face.source >= 0 || front == back) continue;
    if (back >= 0) parts[back].push_back({face.vertices, face.source, face.wall});
    if (front >= 0)
      parts[front].push_back(
          {{face.vertices[2], face.vertices[1], face.vertices[0]}, face.source, face.wall});
  }
  return parts;
}

}  // namespace condyle
