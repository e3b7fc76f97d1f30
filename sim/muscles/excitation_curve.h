#pragma once

#include <vector>

namespace condyle {

/// How a value goes from one knot to the next. step: held until the next. smooth: cubic without
/// overshoot. cubic: each slope as between the neighbours (Catmull-Rom), none at the first and the
/// last knot, as ArtiSynth reads its probes.
enum class Between { step, linear, smooth, cubic };

/// A value over time by its knots; constant beyond them.
class ExcitationCurve {
 public:
  /// times strictly increasing, as many as values, at least 1.
  ExcitationCurve(std::vector<double> times, std::vector<double> values, Between between);
  double operator()(double time_s) const;

 private:
  Between between_;
  std::vector<double> times_, values_, slopes_;
};

}  // namespace condyle
