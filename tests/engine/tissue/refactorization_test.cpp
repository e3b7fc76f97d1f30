#include "engine/tissue/refactorization.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tools/bench/baseline/synthetic_set.h"

namespace condyle {
namespace {

// Where springs are about to buckle, the energy has a plateau: iterations are short there,
// and 0.15 mm are left.
TEST(Refreshing, AConfirmedEndIsNoPlateau) {
  const SyntheticSet set = make_synthetic_set(size_of_nodes(20164));
  const Pose lower = synthetic_pose(0.0873, {0, -2, -2});
  const MeshLoads loads = synthetic_loads(set, lower);
  SpringPrismEnergy energy(set.mesh, loads, 2);
  const HessianFactor at_rest(set.mesh, synthetic_loads(set, Pose{}), set.sheets, set.rest, 2);
  MinimizeSettings settings;
  settings.tolerance_mm = 3e-3;
  settings.max_step_mm = 30;
  for (const RefactorPolicy& policy : {large_mesh_policy, largest_mesh_policy}) {
    Nodes confirmed = set.rest;
    EXPECT_TRUE(
        minimize_with_refactorization(set.mesh, loads, energy, at_rest, settings, confirmed, policy)
            .converged());
    Nodes exactly = confirmed;
    MinimizeSettings tight = settings;
    tight.tolerance_mm = 1e-5;
    EXPECT_TRUE(minimize_with_refactorization(set.mesh, loads, energy,
                                              at_rest.anew(set.mesh, loads, exactly, 2), tight,
                                              exactly)
                    .converged());
    double error = 0;
    for (std::size_t i = 0; i < exactly.size(); ++i)
      error = std::max(error, (exactly[i] - confirmed[i]).norm());
    EXPECT_LT(error, settings.tolerance_mm);
  }
}

}  // namespace
}  // namespace condyle
