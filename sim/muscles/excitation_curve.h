#pragma once

#include <vector>

namespace condyle {

/// Interpolation between knots. step: constant up to the next knot. smooth: monotone cubic without
/// overshoot. cubic: Catmull-Rom with zero slope at the first and last knot, as in ArtiSynth
/// probes.
enum class Interpolation { step, linear, smooth, cubic };

/// A value over time, interpolated between knots and constant beyond them.
class ExcitationCurve {
 public:
  /// `times` strictly increasing, one per value, at least one.
  ExcitationCurve(std::vector<double> times, std::vector<double> values, Interpolation kind);
  double operator()(double time_s) const;

 private:
  Interpolation interpolation_;
  std::vector<double> times_, values_, slopes_;
};

}  // namespace condyle
