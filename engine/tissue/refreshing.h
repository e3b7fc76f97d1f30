#pragma once

#include "engine/minimize/minimize.h"
#include "engine/tissue/hessian_factor.h"

namespace condyle {

/// When the preconditioner is made anew, in iterations: fixed, so that the bits do not depend on
/// timing.
struct RefreshSchedule {
  int first = 3;   // with the factor that is given
  int later = 12;  // with each one made on the way
};

/// The preconditioned method for a long way from where its factor was made: springs that have begun
/// to push and tissue that has turned ask for a factor of the state on the way.
MinimizeResult minimize_refreshing(const SpringPrismNet& net, const NetLoads& loads,
                                   SpringPrismEnergy& energy, const HessianFactor& factor,
                                   const MinimizeSettings& settings, Nodes& x,
                                   const RefreshSchedule& schedule = {});

}  // namespace condyle
