#include "sim/graft/face_contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double grid_mm = 0.5;

double turn(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  return (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x();
}

}  // namespace

FaceContact face_contact(const TriMesh& piece, const std::vector<int>& wall, int face,
                         const Plane& plane, const GapAt& gap) {
  const Vector3d u = plane.normal.unitOrthogonal(), v = plane.normal.cross(u);
  const auto flat = [&](const Vector3d& p) { return Vector2d(u.dot(p), v.dot(p)); };
  FaceContact found;
  std::set<std::pair<int, int>> cells;  // in order, each once
  for (std::size_t t = 0; t < piece.triangles.size(); ++t) {
    if (wall[t] != face) continue;
    const auto& corner = piece.triangles[t];
    const Vector2d a = flat(piece.vertices[corner[0]]), b = flat(piece.vertices[corner[1]]),
                   c = flat(piece.vertices[corner[2]]);
    const double twice = turn(a, b, c);
    found.area_mm2 += 0.5 * twice;
    const Vector2d low = a.cwiseMin(b).cwiseMin(c) / grid_mm,
                   high = a.cwiseMax(b).cwiseMax(c) / grid_mm;
    for (int i = static_cast<int>(std::floor(low.x())); i <= high.x(); ++i)
      for (int k = static_cast<int>(std::floor(low.y())); k <= high.y(); ++k) {
        const Vector2d p = grid_mm * Vector2d(i + 0.5, k + 0.5);
        if (turn(a, b, p) * twice >= 0 && turn(b, c, p) * twice >= 0 && turn(c, a, p) * twice >= 0)
          cells.emplace(i, k);
      }
  }
  double sum = 0;
  int facing = 0;
  for (const auto& [i, k] : cells) {
    const Vector3d p = grid_mm * ((i + 0.5) * u + (k + 0.5) * v) + plane.offset_mm * plane.normal;
    const auto gap_mm = gap(p);
    if (!gap_mm) continue;
    ++facing;
    sum += std::max(*gap_mm, 0.);
    found.largest_gap_mm = std::max(found.largest_gap_mm, *gap_mm);
    if (*gap_mm <= contact_gap_mm) found.contact_mm2 += grid_mm * grid_mm;
  }
  if (facing > 0) found.mean_gap_mm = sum / facing;
  if (!cells.empty()) found.facing_share = facing / static_cast<double>(cells.size());
  return found;
}

}  // namespace condyle
