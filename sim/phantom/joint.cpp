#include <cmath>

#include "engine/field/smooth.h"
#include "engine/math/pchip.h"
#include "sim/phantom/bone_shapes.h"
#include "sim/phantom/phantom_solid.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

const Vector3d condyle_axes(10, 5, 5.5);
constexpr double lateral_pole_forward_deg = -14;  // about z

}  // namespace

CondylarPath phantom_condylar_path() {
  // Steepest 42 degrees down the eminence, flat beyond its crest.
  return {{0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 19.5},
          {0, 1.3, 3.1, 4.8, 6.1, 6.85, 7.2, 7.35, 7.35, 7.3, 7.2}};
}

Primitive condyle_shape() {
  return ellipsoid(condyle_center, condyle_axes, axis_rotation('z', lateral_pole_forward_deg));
}

Primitive fossa_cut() {
  const auto path = phantom_condylar_path();
  std::vector<double> s{-3}, dz{0.15};
  for (std::size_t i = 0; i < path.forward_mm.size(); ++i) {
    s.push_back(path.forward_mm[i]);
    dz.push_back(-path.inferior_mm[i]);
  }
  const Pchip rise(s, dz);
  std::vector<Primitive> parts;
  for (const double at :
       {-1.0, 0.0, 1.5, 3.0, 4.5, 6.0, 7.5, 9.0, 10.5, 12.0, 13.5, 15.0, 16.5, 18.5}) {
    // Thinner disc on the slope; more clearance at the crest, for the condylar neck at wide
    // opening.
    const double above =
        2.15 - 0.7 * std::clamp(at / 4, 0.0, 1.0) + 0.8 * smooth_step((at - 9) / 7);
    parts.push_back(ellipsoid(condyle_center + Vector3d(0, -at, rise(at)),
                              condyle_axes + Vector3d(2.2, 1.9, above),
                              axis_rotation('z', lateral_pole_forward_deg)));
  }
  return {[parts](const Vector3d& p) {
            double d = parts[0].distance(p);
            for (std::size_t i = 1; i < parts.size(); ++i)
              d = smooth_min(d, parts[i].distance(p), 1.2);
            return d;
          },
          {Vector3d(30, -42, -25), Vector3d(66, 2, 4)}};
}

}  // namespace condyle
