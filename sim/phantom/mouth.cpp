#include <cmath>

#include "engine/field/smooth.h"
#include "sim/phantom/bone_shapes.h"
#include "sim/phantom/lookup.h"
#include "sim/phantom/soft_shapes.h"
#include "sim/phantom/tooth_shapes.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Outline of the upper arch seen from below, offset from the crowns by the space behind the lips.
std::vector<Vector2d> arch_outline() {
  const double room = 1.6;
  std::vector<Vector2d> left;
  for (const auto& tooth : tooth_frames(true)) {
    const bool front = tooth.name[0] == 'I' || tooth.name == "C";
    const Vector2d outward = tooth.labial.head<2>().normalized();
    left.push_back(tooth.tip.head<2>() + outward * ((front ? 0.4 : tooth.depth / 2) + room));
  }
  left.emplace_back(33, -43);
  left.emplace_back(25, -33);
  std::vector<Vector2d> points(left);
  for (std::size_t i = left.size(); i-- > 0;) points.emplace_back(-left[i].x(), left[i].y());
  return closed_outline(points, 4);
}

/// Distance in plan to the outline; the lower arch lies inside the upper one.
Distance arch_plan() {
  const auto outline = arch_outline();
  return [outline](const Vector3d& p) {
    return polygon_distance(outline, p.head<2>()) + 2.0 * smooth_step((-49 - p.z()) / 5);
  };
}

/// Mucosa: 1 mm on the bone near the arch, and a collar around each neck.
FieldRecipe gums(bool upper, const FieldRecipe& bone, const Distance& region) {
  const Eigen::AlignedBox3d box =
      upper ? Eigen::AlignedBox3d(Vector3d(-36, -104, -60), Vector3d(36, -30, -22))
            : Eigen::AlignedBox3d(Vector3d(-38, -100, -76), Vector3d(38, -34, -44));
  FieldRecipe gum(Symmetry::mirror_x);
  gum.add(
      {[bone, region](const Vector3d& p) { return smooth_max(bone(p) - 1.0, region(p), 3); }, box},
      0);
  for (const auto& tooth : tooth_frames(upper)) gum.add(tooth_collar(tooth, 0.8), 1.6);
  return gum;
}

}  // namespace

double lip_line(double x, double y) {
  static const Lookup height({0, 5, 12, 19, 24.5}, {-50.7, -50.3, -50.6, -50.7, -50.9});
  const double front = -102 + 9.5 * x * x / (mouth_corner_x * mouth_corner_x);
  return height(std::abs(x)) + 2.2 * smooth_step((y - front) / 6);
}

Primitive oral_space() {
  const Distance plan = arch_plan();
  return {[plan](const Vector3d& p) {
            return smooth_max(plan(p), std::max(p.z() + 39, -63 - p.z()), 5);
          },
          {Vector3d(0, -104, -66), Vector3d(40, -28, -36)}};
}

FieldRecipe upper_gums_recipe() {
  const Distance plan = arch_plan();
  return gums(true, skull_recipe(), [plan](const Vector3d& p) {
    const double d = plan(p);
    const double ceiling = -36 + 9 * smooth_step((-9 - d) / 6);  // higher inside: the palate
    const double behind = std::max(-58 - p.z(), p.y() + 44);     // and not on the pterygoids
    return smooth_max(smooth_max(d + 0.3, p.z() - ceiling, 3), behind, 2);
  });
}

FieldRecipe lower_gums_recipe() {
  const Distance plan = arch_plan();
  return gums(false, mandible_recipe(), [plan](const Vector3d& p) {
    const double d = plan(p), floor = -64.5 - 5 * smooth_step((-9 - d) / 6);
    return smooth_max(smooth_max(d + 0.3, floor - p.z(), 3), p.z() + 46, 2);
  });
}

FieldRecipe tongue_recipe() {
  FieldRecipe tongue(Symmetry::mirror_x);
  tongue.add(
      flat_tube({{0, -83, -54.5}, {0, -75, -51}, {0, -62, -47.5}, {0, -50, -49}, {0, -42, -58}},
                {4.5, 7, 9.5, 11, 12}, {8.5, 11.8, 14.2, 16, 16}, {1, 0, 0}, 6),
      0);
  tongue.add(flat_tube({{0, -79, -64}, {0, -62, -64}, {0, -46, -66}}, {4, 5, 6}, {13, 20, 24},
                       {1, 0, 0}, 6),
             6);  // floor of the mouth
  tongue.cut(
      tube({{0, -86, -48}, {0, -75, -42.2}, {0, -62, -36.6}, {0, -50, -36.5}}, {.4, 1, 1.2, 1}),
      5);  // furrow
  const Eigen::AlignedBox3d box(Vector3d(-40, -100, -80), Vector3d(40, -30, -44));
  const FieldRecipe gum = lower_gums_recipe();
  tongue.cut({[gum](const Vector3d& p) { return gum(p) - 0.4; }, box}, 1.5);
  return tongue;
}

}  // namespace condyle
