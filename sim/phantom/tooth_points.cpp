#include <algorithm>

#include "sim/phantom/phantom_solid.h"
#include "sim/phantom/tooth_shapes.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The outermost point of a tooth on a line along its axis through `from`.
Vector3d crown_point(const ToothSolid& tooth, const ToothFrame& frame, const Vector3d& from) {
  double outside = 2, inside = -4;  // mm along the axis
  for (double w = outside; w > inside; w -= 0.05) {
    if (tooth.solid(from + w * frame.axis) < 0) {
      inside = w;
      break;
    }
    outside = w;
  }
  for (int i = 0; i < 30; ++i) {
    const double middle = (outside + inside) / 2;
    (tooth.solid(from + middle * frame.axis) < 0 ? inside : outside) = middle;
  }
  return from + outside * frame.axis;
}

/// Summit of the carved crown near its uncarved tip, by a pattern search across the axis; of an
/// incisor in the middle of its edge.
Vector3d summit(const ToothSolid& tooth, const ToothFrame& frame, const Vector3d& start) {
  constexpr double reach_mm = 1.5;
  const bool incisor = frame.name[0] == 'I';
  Vector2d at = Vector2d::Zero();
  const auto point = [&](const Vector2d& q) {
    return crown_point(tooth, frame, start + q.x() * frame.distal + q.y() * frame.labial);
  };
  Vector3d best = point(at);
  for (double step = 0.4; step > 0.005; step /= 2) {
    for (bool higher = true; higher;) {
      higher = false;
      for (const Vector2d& d :
           {Vector2d(0, step), Vector2d(0, -step), Vector2d(step, 0), Vector2d(-step, 0)}) {
        if (incisor && d.x() != 0) continue;
        if ((at + d).norm() > reach_mm) continue;
        const Vector3d next = point(at + d);
        if ((next - best).dot(frame.axis) <= 1e-9) continue;
        at += d;
        best = next;
        higher = true;
      }
    }
  }
  return best;
}

}  // namespace

std::vector<ToothPoints> tooth_points(const PhantomSolid& solid) {
  std::vector<ToothPoints> points;
  const auto& frames = tooth_frames();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const ToothFrame& frame = frames[i];
    const ToothSolid& tooth = solid.teeth[i];
    const Vector3d tip = summit(tooth, frame, tooth_tip(frame));
    const ToothPoints left{frame.fdi, tip, tooth_apex(frame), frame.axis};
    const auto mirrored = [](const Vector3d& p) { return Vector3d(-p.x(), p.y(), p.z()); };
    points.push_back(left);
    points.push_back(
        {tooth.right_fdi, mirrored(left.tip), mirrored(left.apex), mirrored(left.axis)});
  }
  std::sort(points.begin(), points.end(),
            [](const ToothPoints& a, const ToothPoints& b) { return a.fdi < b.fdi; });
  return points;
}

}  // namespace condyle
