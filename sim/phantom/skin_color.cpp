#include <algorithm>
#include <cmath>

#include "engine/field/smooth.h"
#include "sim/phantom/lookup.h"
#include "sim/phantom/soft_shapes.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Smooth blotches of about `size` mm, -1 to 1: a few crossed waves.
double mottle(const Vector3d& p, double size) {
  const double f = 2 / size;
  return (std::sin(f * (1.0 * p.x() + 0.7 * p.z()) + 0.3) *
              std::sin(f * (0.9 * p.y() - 0.4 * p.z())) +
          std::sin(f * 1.7 * (0.6 * p.y() + 0.8 * p.z()) + 1.1) *
              std::sin(f * 1.9 * (0.8 * p.x() - 0.5 * p.y()))) /
         2;
}

}  // namespace

Eigen::Vector3f skin_color(const Vector3d& at) {
  static const Lookup brow_height({8, 10, 20, 34, 46, 50}, {31, 31.5, 34.5, 36.6, 33.2, 32}),
      brow_width({8, 12, 20, 34, 46, 50}, {.6, 2.6, 2.9, 2.2, .9, .5}),
      hair_line({-95, -80, -50, -20, 30, 100}, {78, 74, 48, 18, -22, -38});
  static const Primitive lids = lid_opening();
  // A radius is an offset of the distance: negative, it weakens the shade.
  static const Primitive alar_crease = tube({{17, -99.5, -12.5},
                                             {17.8, -98.3, -16.5},
                                             {18, -97, -20.5},
                                             {16.6, -96.8, -25.5},
                                             {12.5, -97, -28}},
                                            {-.9, .1, .3, -.3, -1});
  const double x = std::abs(at.x()), y = at.y(), z = at.z();
  const Vector3d p(x, y, z);
  Vector3d color(.855, .665, .575);
  const auto mix = [&](const Vector3d& other, double weight) {
    const double w = std::clamp(weight, 0.0, 1.0);
    color = color * (1 - w) + other * w;
  };
  const auto spot = [&](const Vector3d& c, const Vector3d& r) {
    return std::exp(-((p - c).cwiseQuotient(r)).squaredNorm());
  };
  mix({.82, .58, .48}, .25 * mottle(at, 26) + .12 * mottle(at, 7));
  const double blood = 1 + .45 * mottle(at, 15) + .2 * mottle(at, 5);
  mix({.90, .73, .62}, .45 * spot({0, -95, 52}, {46, 34, 26}));            // forehead
  mix({.88, .72, .61}, .35 * spot({20, -98, -6}, {9, 12, 12}));            // beside the nose
  mix({.83, .49, .43}, .37 * blood * spot({44, -74, -16}, {21, 28, 18}));  // cheek
  mix({.83, .49, .43}, .34 * blood * spot({0, -116, -16}, {13, 10, 10}));  // nose
  mix({.82, .47, .42}, .25 * blood * spot({0, -97, -82}, {12, 9, 8}));     // chin
  if (x < 26 && y < -88)                                                   // alar crease
    mix({.60, .36, .30}, .6 * std::exp(-std::pow(alar_crease.distance(p) / 1.5, 2)));
  if (x > 68)  // ear
    mix({.83, .52, .45}, .5 * smooth_step((x - 68) / 8) * spot({84, 14, 0}, {14, 25, 38}));
  mix({.70, .50, .44}, .35 * spot({31, -84, 16}, {17, 14, 9}));  // around the eye
  mix({.64, .50, .50}, .34 * spot({27, -88, 3}, {13, 9, 5}));    // veins below it
  // Shaven beard: denser on chin and upper lip, thinning toward cheek and throat.
  const double beard =
      .9 * spot({0, -98, -76}, {34, 26, 26}) + .8 * spot({0, -105, -37}, {24, 12, 8}) +
      .7 * spot({46, -52, -66}, {26, 34, 24}) + .5 * spot({62, -18, -40}, {14, 16, 30});
  mix({.53, .46, .44}, std::min(beard, 1.0) * (.34 + .10 * mottle(at, 3) + .06 * mottle(at, 11)));

  if (y < -76) {  // lips
    const double s = std::min(x / 25.6, 1.0);
    const double top = -50.6 + (7.6 - 1.6 * std::exp(-std::pow(x / 2.5, 2))) *
                                   std::pow(std::max(1 - std::pow(s, 1.6), 0.0), .55);
    const double bottom = -50.9 - 9.4 * std::pow(1 - s * s, .6);
    const double inside = std::min(top - z, z - bottom);
    const double lip = smooth_step(inside / 1.6 + .5) * smooth_step((27 - x) / 2.5);
    mix({.74, .43, .40}, .85 * lip);
    mix({.55, .28, .26}, .45 * lip * std::exp(-std::pow((z - lip_line(x, y)) / 1.1, 2)));
    mix({.66, .33, .32}, .8 * smooth_step((y + 101 - 14 * s * s) / 4) * lip);  // moist inner side
  }
  if (y < -58) {  // brows
    const double across = (z - brow_height(x)) / (brow_width(x) + .6);
    const double hairs = .88 + .12 * std::sin(3.1 * x - 1.7 * z + 2 * std::sin(.9 * x));
    const double ends = smooth_step((x - 8.5) / 4) * smooth_step((49 - x) / 8);
    mix({.21, .15, .11}, .82 * hairs * ends * std::exp(-std::pow(std::abs(across), 2.6)));
  }
  const double from_eye = (p - eye_center).norm();
  if (from_eye < eye_radius + 3 && y < -74) {  // lash line
    const double lid = lids.distance({x, -100, z});
    const bool upper = z > 13.6 + .1 * (x - 31);
    mix({.24, .15, .12}, (upper ? .9 : .55) * std::exp(-std::pow(lid / (upper ? 1.0 : .7), 2)));
  }
  mix({.78, .47, .43}, .8 * spot({18.6, -80.5, 12.5}, {2.6, 3, 2.2}));  // caruncle
  // Hair cut to the skin: ever fewer and finer towards its border.
  const double above_line =
      z - hair_line(y) + 4 * mottle(at, 23) + 3 * mottle(at, 7) + 3 * mottle(at, 2.6);
  const double hair = smooth_step(above_line / 44 + .4) * (.8 + .2 * smooth_step(above_line / 70));
  const double ear =
      smooth_step((x - 64) / 8) * smooth_step((1.3 - std::hypot((y - 13) / 25, z / 38)) / .35);
  mix({.33, .30, .285}, hair * (1 - ear) * (.62 + .03 * mottle(at, 9) + .05 * mottle(at, 2.6)));
  // The cut through the neck, and a dark border above it.
  mix({.13, .11, .11}, smooth_step((-168 - z) / 20));
  return color.cast<float>();
}

}  // namespace condyle
