#include "sim/phantom/shifted_bite.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/field/primitives.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double gap_mm = 0.07;
// Of a query: where teeth overlap, some of their vertices are at most this far inside.
constexpr double reach_mm = 1;
constexpr double pivot_y = -68, pivot_z = -52, front_y = -76;  // middle of the arches

/// Vertices of an arch that can meet the other one; those of the left half stand for both.
std::vector<Vector3d> crowns(const TriMesh& mesh) {
  std::vector<Vector3d> points;
  for (const auto& p : mesh.vertices)
    if (p.x() >= -1 && p.z() > -62 && p.z() < -44) points.push_back(p);
  return points;
}

Pose placed(double forward, double down, double pitch_deg) {
  const Vector3d pivot(0, pivot_y, pivot_z);
  Pose motion;
  motion.R = axis_rotation('x', pitch_deg);
  motion.t = pivot - motion.R * pivot + Vector3d(0, -forward, -down);
  return motion;
}

class Arches {
 public:
  explicit Arches(const Case& patient)
      : upper_mesh_(patient.find(Role::upper_teeth)->mesh),
        lower_mesh_(patient.find(Role::lower_teeth)->mesh),
        upper_tree_(upper_mesh_),
        lower_tree_(lower_mesh_),
        upper_(crowns(upper_mesh_)),
        lower_(crowns(lower_mesh_)) {}

  /// Whether all distances in front of and behind the middle are at least the gap.
  std::array<bool, 2> free(const Pose& motion) const {
    std::array<bool, 2> result = {true, true};  // front, back
    const Pose inverse = motion.inverse();
    const auto test = [&](const TriangleTree& tree, const Vector3d& q, double y) {
      const std::size_t half = y < front_y ? 0 : 1;
      if (!result[half]) return;
      result[half] = tree.signed_nearest(q, reach_mm).distance >= gap_mm;
    };
    for (const auto& p : lower_) {
      const Vector3d q = motion * p;
      test(upper_tree_, q, q.y());
    }
    for (const auto& p : upper_) test(lower_tree_, inverse * p, p.y());
    return result;
  }

  /// Least descent at which the front or the back is free.
  std::array<double, 2> descents(double forward, double pitch_deg) const {
    std::array<double, 2> down{};
    for (std::size_t half = 0; half < 2; ++half) {
      double low = -2, high = 6;
      for (int i = 0; i < 12; ++i) {
        const double middle = (low + high) / 2;
        (free(placed(forward, middle, pitch_deg))[half] ? high : low) = middle;
      }
      down[half] = high;
    }
    return down;
  }

 private:
  const TriMesh &upper_mesh_, &lower_mesh_;
  TriangleTree upper_tree_, lower_tree_;
  std::vector<Vector3d> upper_, lower_;
};

}  // namespace

Pose shifted_bite(const Case& patient, double forward_mm) {
  if (forward_mm == 0) return {};
  const Arches arches(patient);
  // The pitch at which front and back meet at once; beyond 4 degrees one end stays open.
  double low = -4, high = 4;
  for (int i = 0; i < 8; ++i) {
    const double pitch = (low + high) / 2;
    const auto [front, back] = arches.descents(forward_mm, pitch);
    (front > back ? low : high) = pitch;  // a positive pitch lowers the front
  }
  const double pitch = (low + high) / 2;
  const auto [front, back] = arches.descents(forward_mm, pitch);
  return placed(forward_mm, std::max(front, back), pitch);
}

}  // namespace condyle
