#include <cmath>
#include <numbers>

#include "engine/field/isosurface.h"
#include "engine/field/smooth.h"
#include "sim/phantom/soft_shapes.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double limbus = 5.8, pupil = 1.8, cornea_bulge = 0.6;  // mm

/// Colour of the eye at a distance from the gaze axis, by direction about it.
Vector3f eye_color(double off_axis, double angle) {
  const auto mixed = [](const Vector3f& a, const Vector3f& b, double t) -> Vector3f {
    return a + (b - a) * static_cast<float>(smooth_step(t));
  };
  // Fibres run outward, uneven in width and slightly bent.
  const double turn = angle + .12 * std::sin(1.9 * off_axis);
  const double rays = .5 + .2 * std::sin(19 * turn) + .2 * std::sin(31 * turn + 1) +
                      .1 * std::sin(43 * turn + off_axis);
  const Vector3f white(.84f, .80f, .77f), rim(.13f, .11f, .10f), black(.015f, .012f, .012f);
  const Vector3f outer = mixed({.25f, .20f, .14f}, {.38f, .33f, .24f}, rays);
  const Vector3f inner = mixed({.36f, .23f, .12f}, {.50f, .34f, .19f}, rays);
  Vector3f color = mixed(inner, outer, (off_axis - pupil) / (limbus - pupil) * 1.5);
  color = mixed(color, rim, (off_axis - limbus + 1.3) / 1.2);
  color = mixed(black, color, (off_axis - pupil + .15) / .3);
  color = mixed(color, white, (off_axis - limbus + .25) / .7);
  // Moist and redder toward the corners, with veins.
  const double veins = .75 + .25 * std::sin(23 * angle + 3 * std::sin(1.3 * off_axis));
  return mixed(color, {.76f, .56f, .52f}, veins * (off_axis - 6.5) / 6.5);
}

}  // namespace

TriMesh eyes_surface() {
  // Rings about the gaze axis (-y), close together where the colour changes.
  std::vector<double> off_axis{.5,  1,   1.5, 1.65, 1.95, 2.2, 2.6, 3,   3.4, 3.8, 4.2,
                               4.5, 4.8, 5.1, 5.4,  5.6,  5.8, 6,   6.2, 6.6, 7.1, 7.6};
  std::vector<double> polar;
  for (const double r : off_axis) polar.push_back(std::asin(r / eye_radius));
  for (double a = polar.back() + .07; a < std::numbers::pi - .05; a += .07) polar.push_back(a);
  const int around = 128;
  TriMesh eye;
  const auto add = [&](double a, double turn) {
    const double r = eye_radius * std::sin(a);
    const double ahead =
        a < std::numbers::pi / 2 ? cornea_bulge * (1 - smooth_step(r / (limbus + .6))) : 0;
    const Vector3d direction(std::sin(a) * std::cos(turn), -std::cos(a),
                             std::sin(a) * std::sin(turn));
    eye.vertices.push_back(eye_center + (eye_radius + ahead) * direction);
    eye.colors.push_back(eye_color(a < std::numbers::pi / 2 ? r : 2 * eye_radius - r, turn));
  };
  add(0, 0);
  for (const double a : polar)
    for (int i = 0; i < around; ++i) add(a, 2 * std::numbers::pi * i / around);
  add(std::numbers::pi, 0);
  const int last = static_cast<int>(eye.vertices.size()) - 1;
  const int rings = static_cast<int>(polar.size());
  const auto at = [&](int ring, int i) { return 1 + ring * around + i % around; };
  for (int i = 0; i < around; ++i) {
    eye.triangles.emplace_back(0, at(0, i), at(0, i + 1));
    for (int ring = 0; ring + 1 < rings; ++ring) {
      eye.triangles.emplace_back(at(ring, i), at(ring + 1, i), at(ring + 1, i + 1));
      eye.triangles.emplace_back(at(ring, i), at(ring + 1, i + 1), at(ring, i + 1));
    }
    eye.triangles.emplace_back(last, at(rings - 1, i + 1), at(rings - 1, i));
  }
  add_lashes(eye);
  return with_mirror_image(eye);
}

}  // namespace condyle
