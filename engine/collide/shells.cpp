#include "engine/collide/shells.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

/// A sheet that is covered on both sides is closed by its edges but has no volume.
bool encloses_volume(const TriMesh& mesh) {
  return std::abs(signed_volume(mesh)) > 1e-9 * std::pow(surface_area(mesh), 1.5);
}

/// The connected pieces, in order of first appearance.
std::vector<Shell> split(const TriMesh& mesh) {
  const Components components = find_components(mesh);
  std::vector<Shell> shells(static_cast<std::size_t>(components.count));
  for (auto& shell : shells) shell.closed = true;
  std::vector<int> renumbered(mesh.vertices.size(), -1);
  std::vector<int> place(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    TriMesh& piece = shells[components.of_triangle[i]].mesh;
    Eigen::Vector3i t = mesh.triangles[i];
    for (int k = 0; k < 3; ++k) {  // components share no vertex: one numbering serves all
      int& index = renumbered[t[k]];
      if (index < 0) {
        index = static_cast<int>(piece.vertices.size());
        piece.vertices.push_back(mesh.vertices[t[k]]);
      }
      t[k] = index;
    }
    place[i] = static_cast<int>(piece.triangles.size());
    piece.triangles.push_back(t);
  }

  // Closed: every edge is used equally often in both directions.
  for (auto& shell : shells) shell.rim.assign(shell.mesh.triangles.size(), 0);
  std::vector<bool> on_rim(mesh.vertices.size(), false);
  const EdgeList list = find_edges(mesh);
  for (const Edge& edge : list.edges) {
    int balance = 0;
    for (int i = 0; i < edge.count; ++i) balance += list.sides[edge.first + i].forward ? 1 : -1;
    if (balance == 0) continue;
    on_rim[edge.low] = on_rim[edge.high] = true;
    for (int i = 0; i < edge.count; ++i) {
      const int triangle = list.sides[edge.first + i].triangle;
      Shell& shell = shells[components.of_triangle[triangle]];
      shell.closed = false;
      const auto& t = mesh.triangles[triangle];
      for (int k = 0; k < 3; ++k)
        if (std::minmax(t[k], t[(k + 1) % 3]) == std::minmax(edge.low, edge.high))
          shell.rim[place[triangle]] |= static_cast<std::uint8_t>(1 << k);
    }
  }
  for (Shell& shell : shells) shell.closed = shell.closed && encloses_volume(shell.mesh);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (on_rim[mesh.triangles[i][k]])
        shells[components.of_triangle[i]].rim[place[i]] |= static_cast<std::uint8_t>(8 << k);
  return shells;
}

}  // namespace

void require_sound(const TriMesh& mesh) {
  if (mesh.triangles.empty())
    throw InputError("a surface without triangles cannot collide; omit it");
  const int count = static_cast<int>(mesh.vertices.size());
  for (int v = 0; v < count; ++v)
    if (!mesh.vertices[v].allFinite())
      throw InputError("vertex " + std::to_string(v) +
                       " of a surface has a coordinate that is not a finite number; correct or "
                       "remove it");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (const auto& t = mesh.triangles[i]; t.minCoeff() < 0 || t.maxCoeff() >= count)
      throw InputError("triangle " + std::to_string(i) + " of a surface names vertex " +
                       std::to_string(t.minCoeff() < 0 ? t.minCoeff() : t.maxCoeff()) +
                       ", but there are " + std::to_string(count) + " vertices");
}

std::vector<Shell> solid_shells(const TriMesh& mesh) {
  std::vector<Shell> shells = split(mesh);
  std::vector<bool> inward(shells.size(), false), cavity(shells.size(), false);
  for (std::size_t i = 0; i < shells.size(); ++i)
    inward[i] = shells[i].closed && signed_volume(shells[i].mesh) <= 0;
  if (std::find(inward.begin(), inward.end(), true) == inward.end()) return shells;
  for (std::size_t i = 0; i < shells.size(); ++i) {
    if (!shells[i].closed || inward[i]) continue;
    const TriangleTree outer(shells[i].mesh);
    const Box box = bounding_box(shells[i].mesh);
    for (std::size_t k = 0; k < shells.size(); ++k) {
      const auto& sample = shells[k].mesh.vertices.front();
      if (inward[k] && box.contains(sample) && outer.signed_distance(sample) < 0) cavity[k] = true;
    }
  }
  std::vector<Shell> kept;
  for (std::size_t i = 0; i < shells.size(); ++i) {
    if (cavity[i]) continue;
    if (inward[i])
      for (auto& t : shells[i].mesh.triangles) std::swap(t[1], t[2]);
    kept.push_back(std::move(shells[i]));
  }
  return kept;
}

}  // namespace condyle
