#pragma once

#include "engine/minimize/minimize.h"
#include "engine/tissue/hessian_factor.h"

namespace condyle {

/// When the preconditioner is made anew, in iterations: fixed, so that the bits do not depend on
/// timing. A factor costs as much as a dozen iterations. Far from the minimum it serves for few, as
/// the springs that push change with each; near it the exact one, where it is positive definite,
/// for many.
struct RefreshSchedule {
  int first = 1;     // with the factor that is given
  int far = 1;       // factors made far from the minimum
  int each_far = 4;  // with each of them
  int later = 9;     // with each of the next two; then three more for each further two
  int most = 16;
  /// Whether an exact factor has to confirm the end: a plateau on which tissue is about to buckle
  /// looks like one to any other.
  bool confirm = false;
};
/// For nets of ten thousand nodes and more.
constexpr RefreshSchedule sparing_refreshes{
    .first = 1, .far = 2, .each_far = 1, .later = 8, .most = 20, .confirm = true};

/// The preconditioned method for a long way from where its factor was made: springs that have begun
/// to push and tissue that has turned ask for a factor of the state on the way.
MinimizeResult minimize_refreshing(const SpringPrismNet& net, const NetLoads& loads,
                                   SpringPrismEnergy& energy, const HessianFactor& factor,
                                   const MinimizeSettings& settings, Nodes& x,
                                   const RefreshSchedule& schedule = {});

}  // namespace condyle
