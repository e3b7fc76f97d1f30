#include "engine/tissue/node_extrapolation.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/minimize/minimize.h"
#include "engine/tissue/refactorization.h"
#include "tools/bench/baseline/synthetic_set.h"

namespace condyle {
namespace {

TEST(NodeExtrapolator, ExtrapolatesTheLastChange) {
  NodeExtrapolator own;
  Points next{{1, 2, 3}};
  own.add_frame({{0.10, 0, 0}}, {{0, 0, 0}});
  own.extrapolate(next);
  EXPECT_EQ(next[0].x(), 1) << "one frame has no rate of change";
  own.add_frame({{0.15, 0, 0}}, {{0, 0, 0}});
  own.extrapolate(next);
  EXPECT_NEAR(next[0].x(), 1.20, 1e-12);
}

TEST(NodeExtrapolator, ExtrapolatesAllButNodesThatSnapped) {
  const Points still{{0, 0, 0}, {0, 0, 0}};
  NodeExtrapolator own;
  own.add_frame({{0.1, 0, 0}, {0.10, 0, 0}}, still);
  own.add_frame({{0.6, 0, 0}, {0.12, 0, 0}}, still);
  Points next{{1, 2, 3}, {1, 2, 3}};
  own.extrapolate(next);
  EXPECT_EQ(next[0].x(), 1);
  EXPECT_NEAR(next[1].x(), 1.14, 1e-12);
}

// A tissue whose lower bone opens by half a degree a frame.
struct Opening {
  SyntheticSet set = make_synthetic_set(patient2_size());
  static Pose pose(int frame) { return synthetic_pose(0.0087 * (20 + frame), {0, 0, 0}); }

  /// Median of the iterations of the last frames, with factors made `ahead` at the predicted start
  /// of a frame, or at the end of the previous one.
  int iterations(bool ahead) const {
    constexpr int frames = 13, last = 9;
    MeshLoads loads = synthetic_loads(set, pose(-1));
    SpringPrismEnergy energy(set.mesh, loads, 2);
    MinimizeSettings settings;
    settings.tolerance_mm = 5e-3;
    Nodes x = set.rest;
    HessianFactor factor(set.mesh, loads, set.sheets, x, 2);
    minimize_with_refactorization(set.mesh, loads, energy, factor, settings, x);
    NodeExtrapolator own;
    std::vector<int> used;
    for (int frame = 0; frame < frames; ++frame) {
      loads = synthetic_loads(set, pose(frame));
      const Nodes taken = carried(set, x, pose(frame - 1), pose(frame));
      Nodes next = taken;
      own.extrapolate(next);
      factor = factor.anew(set.mesh, loads, ahead ? next : x, 2);
      settings.fresh = ahead;
      const auto result = minimize(energy, factor, settings, next);
      EXPECT_TRUE(result.converged());
      used.push_back(result.iterations);
      own.add_frame(next, taken);
      x = next;
    }
    std::nth_element(used.end() - last, used.end() - last / 2 - 1, used.end());
    return used[frames - last / 2 - 1];
  }
};

TEST(NodeExtrapolator, AFactorOfWhereTheFrameBeginsNeedsOneStep) {
  const Opening opening;
  EXPECT_EQ(opening.iterations(true), 1);
  EXPECT_GE(opening.iterations(false), 2);
}

}  // namespace
}  // namespace condyle
