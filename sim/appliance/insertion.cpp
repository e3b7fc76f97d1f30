#include "sim/appliance/insertion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/units.h"
#include "engine/mesh/measure.h"
#include "sim/appliance/grid_frame.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double tilt_step_deg = 2;
// A direction far from the middle must be better by this fraction of the whole area per degree.
constexpr double cost_per_degree = 2e-4;

}  // namespace

Vector3d find_insertion(const TriMesh& surface, const std::vector<char>& counts,
                        const Vector3d& about, double most_tilt_deg) {
  std::vector<Vector3d> areas;
  double whole = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (!counts[t]) continue;
    const auto& v = surface.triangles[t];
    areas.push_back(0.5 * (surface.vertices[v[1]] - surface.vertices[v[0]])
                              .cross(surface.vertices[v[2]] - surface.vertices[v[0]]));
    whole += areas.back().norm();
  }
  const Matrix3d axes = axes_along(about.normalized()).transpose();
  Vector3d best = about.normalized();
  double least = 1e300;
  const int rings = static_cast<int>(most_tilt_deg / tilt_step_deg);
  for (int ring = 0; ring <= rings; ++ring) {
    const int count = std::max(1, 6 * ring);
    for (int i = 0; i < count; ++i) {
      const double tilt = ring * tilt_step_deg * degree, turn = 360 * degree * i / count;
      const Vector3d d = axes * Vector3d(std::sin(tilt) * std::cos(turn),
                                         std::sin(tilt) * std::sin(turn), std::cos(tilt));
      double hidden = whole * cost_per_degree * ring * tilt_step_deg;
      for (const Vector3d& area : areas) hidden += std::max(0.0, area.dot(d));
      if (hidden < least) {
        least = hidden;
        best = d;
      }
    }
  }
  return best;
}

ReliefField::ReliefField(const TriMesh& on, const Vector3d& seat, const Box& box, double voxel_mm,
                         double band_mm, int threads)
    : R_FG_(axes_along(seat)) {
  const TriMesh turned = in_axes(on, R_FG_);
  Box reach;
  for (int c = 0; c < 8; ++c)
    reach.add(R_FG_ * Vector3d(c & 1 ? box.high.x() : box.low.x(),
                               c & 2 ? box.high.y() : box.low.y(),
                               c & 4 ? box.high.z() : box.low.z()));
  field_ = mesh_field(turned, even_grid({reach.low, reach.high}, voxel_mm), band_mm, threads);
  // Out of the grid against the seat: what lies below a sample is on its path.
  sweep(field_, Sweep::up, threads);
}

double ReliefField::operator()(const Vector3d& p) const { return even_value(field_, R_FG_ * p); }

}  // namespace condyle
