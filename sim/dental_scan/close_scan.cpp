#include "sim/dental_scan/close_scan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "engine/cut/fill_loops.h"
#include "engine/mesh/holes.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/rims.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

double length_of(const TriMesh& mesh, const std::vector<int>& rim) {
  double length = 0;
  for (std::size_t i = 0; i < rim.size(); ++i)
    length += (mesh.vertices[rim[i]] - mesh.vertices[rim[(i + 1) % rim.size()]]).norm();
  return length;
}

/// Appends a flat cover whose border runs along a ring of vertices.
void cover(TriMesh& mesh, const std::vector<int>& ring, const Vector3d& normal) {
  const Vector3d right = normal.unitOrthogonal(), up = normal.cross(right);
  std::vector<Eigen::Vector2d> flat;
  for (const int v : ring) flat.emplace_back(right.dot(mesh.vertices[v]), up.dot(mesh.vertices[v]));
  std::vector<int> loop(ring.size());
  std::iota(loop.begin(), loop.end(), 0);
  for (const auto& t : fill_loops(flat, {loop}).triangles)
    mesh.triangles.emplace_back(ring[t[0]], ring[t[1]], ring[t[2]]);
}

/// Twice the vector area of a ring.
Vector3d area_vector(const TriMesh& mesh, const std::vector<int>& ring) {
  Vector3d sum = Vector3d::Zero();
  const Vector3d& origin = mesh.vertices[ring.front()];
  for (std::size_t i = 0; i < ring.size(); ++i)
    sum += (mesh.vertices[ring[i]] - origin)
               .cross(mesh.vertices[ring[(i + 1) % ring.size()]] - origin);
  return sum;
}

/// Continues a rim downward. Returns the lower ring, in the same order, evened sideways.
std::vector<int> add_skirt(TriMesh& mesh, const std::vector<int>& rim, const Vector3d& down,
                           double skirt_mm) {
  constexpr int smoothings = 5;
  const std::size_t count = rim.size();
  std::vector<Vector3d> ring;
  for (const int v : rim) ring.push_back(mesh.vertices[v] + skirt_mm * down);
  for (int k = 0; k < smoothings; ++k) {
    const std::vector<Vector3d> before = ring;
    for (std::size_t i = 0; i < count; ++i)
      ring[i] =
          0.5 * before[i] + 0.25 * (before[(i + 1) % count] + before[(i + count - 1) % count]);
  }
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), ring.begin(), ring.end());
  std::vector<int> lower(count);
  std::iota(lower.begin(), lower.end(), first);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    mesh.triangles.emplace_back(rim[i], rim[next], lower[i]);
    mesh.triangles.emplace_back(lower[i], rim[next], lower[next]);
  }
  return lower;
}

}  // namespace

ClosedScan close_scan(TriMesh mesh, const Vector3d& down, double skirt_mm) {
  ClosedScan result;
  mesh.colors.clear();
  result.holes = close_small_holes(mesh).holes;
  const Components pieces = find_components(mesh);
  std::vector<int> piece_of(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const int v : mesh.triangles[t]) piece_of[v] = pieces.of_triangle[t];
  const auto rims = rims_of(mesh);
  std::vector<double> longest(static_cast<std::size_t>(pieces.count), 0);
  for (const auto& rim : rims) {
    double& length = longest[static_cast<std::size_t>(piece_of[rim.front()])];
    length = std::max(length, length_of(mesh, rim));
  }
  for (const auto& rim : rims) {
    double& length = longest[static_cast<std::size_t>(piece_of[rim.front()])];
    if (length_of(mesh, rim) == length) {
      length = -1;  // once a piece
      cover(mesh, add_skirt(mesh, rim, down, skirt_mm), down);
      ++result.skirts;
    } else {
      cover(mesh, rim, area_vector(mesh, rim).normalized());
      ++result.holes;
    }
  }
  result.closed = inspect(mesh).closed();
  result.mesh = std::move(mesh);
  return result;
}

}  // namespace condyle
