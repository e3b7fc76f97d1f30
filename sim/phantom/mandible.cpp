#include <cmath>

#include "engine/field/smooth.h"
#include "sim/phantom/bone_shapes.h"
#include "sim/phantom/tooth_shapes.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Side view of the ramus, (y, z).
const std::vector<Vector2d> ramus_outline = {
    {-43.2, -9.5}, {-40.5, -12}, {-38, -17},   {-34, -20.5}, {-28, -21.5}, {-23, -19},
    {-19.5, -14},  {-17, -9},    {-10, -8},    {-10.5, -16}, {-13, -24},   {-14, -34},
    {-13.5, -45},  {-12.5, -55}, {-14.5, -62}, {-21, -67.5}, {-30, -71},   {-38, -74},
    {-46, -72},    {-48, -58},   {-45, -50},   {-40, -43},   {-38.8, -36}, {-40.5, -28},
    {-43.2, -20},  {-44.6, -13}};

/// Mid-plane of the ramus: x at (y, z).
double ramus_middle(double y, double z) {
  const double q = z + 50;
  return 46 + (.42 - .27 * smooth_step((z + 58) / 50)) * (y + 14) +
         .055 * (q + std::sqrt(q * q + 150));
}

/// A plate of varying thickness about the curved mid-plane, edges rounded by 3 mm.
Primitive ramus() {
  const auto outline = closed_outline(ramus_outline, 2);
  return {[outline](const Vector3d& p) {
            const double y = p.y(), z = p.z();
            const double d2 = polygon_distance(outline, {y, z}) + 1;
            const double half = 3.6 + 1.0 * smooth_step((-40 - z) / 26) +
                                1.4 * smooth_step((-34 - y) / 12) * smooth_step((-32 - z) / 14) -
                                .8 * smooth_step((z + 28) / 18);
            const double over = std::abs(p.x() - ramus_middle(y, z)) - half + 3;
            const double a = std::max(d2 + 3, 0.0), b = std::max(over, 0.0);
            return (std::sqrt(a * a + b * b) + std::min(std::max(d2 + 3, over), 0.0) - 3) * .96;
          },
          {Vector3d(28, -56, -80), Vector3d(60, -4, -4)}};
}

void add_lower_alveolar_process(FieldRecipe& bone) {
  struct Row {
    double depth, radius;
  };
  for (const auto& row : {Row{4.4, 4.2}, Row{9, 5.0}, Row{14.5, 5.4}}) {
    std::vector<Vector3d> points;
    for (const auto& tooth : tooth_frames(false))
      points.push_back(tooth.neck() - tooth.axis * row.depth);
    points.insert(points.begin(), Vector3d(0, points[0].y(), points[0].z()));
    points.push_back(points.back() + Vector3d(2.2, 7, 1.5));
    std::vector<double> radii(4, row.radius * .92);
    radii.resize(points.size(), row.radius);
    bone.add(tube(points, radii, 3), 7);
  }
}

}  // namespace

FieldRecipe mandible_recipe() {
  FieldRecipe bone(Symmetry::mirror_x);
  const std::vector<double> x = {0, 8, 15, 21, 26, 30, 34, 37.4, 39.8, 41.5},
                            y = {-81.5, -80.5, -76.5, -70, -62, -53, -44, -34.5, -26, -19},
                            lower = {-91, -91, -90.3, -88.5, -85.5, -82, -78.5, -74.5, -71, -67.5};
  std::vector<Vector3d> basal;
  for (std::size_t i = 0; i < x.size(); ++i) basal.emplace_back(x[i], y[i] - 1, lower[i] + 6.6);
  bone.add(flat_tube(basal, {6.6, 6.6, 6.6, 6.6, 6.6, 6.6, 6.6, 6, 5, 4},
                     {6.2, 5.8, 5.2, 5, 4.9, 4.9, 4.9, 4.4, 3.2, 2.2}, {.6, -.8, 0}, 9),
           0);
  bone.add(
      flat_tube({{0, -84.3, -77},
                 {8, -83.3, -77},
                 {15, -79.3, -76},
                 {20.5, -72.5, -75},
                 {25, -64.5, -72.5},
                 {29, -55.5, -69},
                 {33, -46.5, -66},
                 {36.5, -38, -63}},
                std::vector<double>(8, 8), {5, 4.8, 4.8, 4.9, 5.1, 5.2, 4.8, 4}, {.7, -.7, 0}, 9),
      6);
  add_lower_alveolar_process(bone);
  bone.add(ramus(), 9);
  bone.add(
      tube({{46, -41.5, -24}, {41.5, -41, -40}, {36, -46, -54}, {31, -54, -62}}, {3, 4.2, 4.5, 3}),
      6);  // oblique line
  bone.add(flat_tube({{50.5, -13, -9.5}, {50, -13, -14}, {48.8, -13.5, -22}, {48, -16, -32}},
                     {4.6, 4.2, 4, 3}, {8.2, 6, 3.9, 2}, {1, -.2, 0}),
           5);  // neck
  bone.add(condyle_shape(), 2);
  bone.add(flat_tube({{47, -42, -11}, {46.2, -40.6, -19}, {45, -38.5, -28}}, {3.2, 5.5, 5},
                     {2.2, 2.6, 1.6}, {1, 0, 0}),
           6);                                             // coronoid
  bone.add(ellipsoid({0, -82.8, -83.5}, {11, 5., 7}), 6);  // chin
  bone.add(ellipsoid({12, -80.5, -87}, {6.5, 5.5, 4.6}), 6);
  bone.cut(ellipsoid({0, -94, -70}, {15, 5, 5.5}), 8);  // hollow above the chin
  // Mental foramen, below the second premolar; it opens to the side, back and up.
  bone.cut(tube({{31.5, -74.4, -71.6}, {25.2, -76.4, -74.8}}, {2, 1.4}), 1);
  return bone;
}

}  // namespace condyle
