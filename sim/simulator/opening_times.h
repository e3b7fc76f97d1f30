#pragma once

#include <vector>

#include "sim/case/case.h"
#include "sim/motion/motion.h"

namespace condyle {

/// Finds the time at which a motion has opened the mouth to an amount. Samples of the motion are
/// cached, so that only the first queries cost as much as sampling it.
class OpeningTimes {
 public:
  /// Patient and motion must outlive it.
  OpeningTimes(const Case& patient, const Motion& motion) : patient_(patient), motion_(motion) {}

  /// Time at which the motion first opens by `opening_mm`, or opens widest if it does not open so
  /// far; found by bisection between rest and that sample.
  double time_of(double opening_mm);

 private:
  double opening_at(double time_s) const;
  double sampled_opening(int sample);

  const Case& patient_;
  const Motion& motion_;
  std::vector<double> sampled_mm_;  // at equal intervals from the start, as far as requested
};

}  // namespace condyle
