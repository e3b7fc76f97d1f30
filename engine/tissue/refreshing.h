#pragma once

#include "engine/minimize/minimize.h"
#include "engine/tissue/hessian_factor.h"

namespace condyle {

/// When the preconditioner is made anew, in iterations: fixed, so that the bits do not depend on
/// timing. Far from the minimum a factor serves for one iteration: the springs that push change
/// with each. Near it the exact one, where it is positive definite, brings two to three digits.
struct RefreshSchedule {
  int first = 1;  // with the factor that is given, and with each made far from the minimum
  int far = 2;    // factors made far from the minimum
  int later = 4;  // with each of the next two; then three more for each further two
  int most = 12;
};
/// For nets of ten thousand nodes and more, where a factor costs as much as dozens of iterations.
constexpr RefreshSchedule sparing_refreshes{.first = 1, .far = 2, .later = 8, .most = 20};

/// The preconditioned method for a long way from where its factor was made: springs that have begun
/// to push and tissue that has turned ask for a factor of the state on the way.
MinimizeResult minimize_refreshing(const SpringPrismNet& net, const NetLoads& loads,
                                   SpringPrismEnergy& energy, const HessianFactor& factor,
                                   const MinimizeSettings& settings, Nodes& x,
                                   const RefreshSchedule& schedule = {});

}  // namespace condyle
