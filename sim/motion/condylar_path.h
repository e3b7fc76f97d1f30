#pragma once

#include "engine/math/pchip.h"
#include "sim/case/case.h"

namespace condyle {

constexpr double radian_per_degree = 3.14159265358979323846 / 180;

/// Condyles travel 10 to 20 mm; past the crest of the eminence ligaments let them go no farther.
constexpr double longest_forward_mm = 16.5;

/// How far the condyles have moved forward when the jaw has turned by theta: a hinge first, then
/// both together, and at the end of their travel a hinge again; `early` mixes in translation from
/// the start.
struct Coupling {
  double hinge = 12 * radian_per_degree;        // rad turned before translation begins
  double rad_per_mm = 1.5 * radian_per_degree;  // of forward travel after that
  double early = 0;                             // 0 hinge first, 1 in proportion from the start

  double forward_mm(double theta) const;
  /// Inverse, from 0 to below the longest travel; 0 for 0.
  double theta(double forward_mm) const;
};

/// Drop of the condyle centres (toward -z, mm) by their forward travel (toward -y, mm).
/// The path of a patient whose joint is known.
Pchip known_path(const CondylarPath& path);
/// An average joint: 40 deg secant over the first 5 mm, flat past the crest of the eminence.
Pchip average_path();
/// A path whose secant over the first 5 mm is inclined by so much, flat past the crest; `shape`
/// from 0 (straight to the crest) to 1 (an eminence's curve).
Pchip inclined_path(double inclination_deg, double shape);

}  // namespace condyle
