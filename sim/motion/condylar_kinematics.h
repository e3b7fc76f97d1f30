#pragma once

#include "engine/core/units.h"
#include "engine/math/pchip.h"
#include "sim/case/case.h"

namespace condyle {

/// Condyles travel 10 to 20 mm; past the crest of the eminence ligaments limit them.
constexpr double longest_forward_mm = 16.5;

/// Coupling of rotation and translation: forward travel of the condyles at rotation theta. A hinge
/// first, then rotation with translation, and a hinge again at the end of travel; `early` blends in
/// translation from the start. No travel at less rotation than `closed`.
struct Coupling {
  double hinge = 12 * degree;        // rad, rotation before translation begins
  double rad_per_mm = 1.5 * degree;  // of forward travel thereafter
  double early = 0;                  // 0 hinge first, 1 in proportion from the start
  double closed = 0;                 // rotation of the closed position, at which the hinge starts

  double forward_mm(double theta) const;
  /// Inverse, from the closed position, for 0 up to less than longest_forward_mm; 0 for 0.
  double theta(double forward_mm) const;
};

/// Condylar path: inferior translation of the condyle centres (toward -z, mm) by forward travel
/// (toward -y, mm). The path given in the case.
Pchip path_of_case(const CondylarPath& path);
/// An average joint: 40 deg secant over the first 5 mm, flat past the crest of the eminence.
Pchip average_path();
/// A path of the given secant inclination over the first 5 mm, flat past the crest; `shape` from 0
/// (straight to the crest) to 1 (curved as an eminence).
Pchip inclined_path(double inclination_deg, double shape);

}  // namespace condyle
