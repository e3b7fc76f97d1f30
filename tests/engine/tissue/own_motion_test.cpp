#include "engine/tissue/own_motion.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/minimize/minimize.h"
#include "engine/tissue/refreshing.h"
#include "engine/tissue/synthetic_set.h"

namespace condyle {
namespace {

TEST(OwnMotion, GoesOnAsItChanged) {
  OwnMotion own;
  Points next{{1, 2, 3}};
  own.frame_ended({{0.10, 0, 0}}, {{0, 0, 0}});
  own.foretell(next);
  EXPECT_EQ(next[0].x(), 1) << "one frame tells of no change";
  own.frame_ended({{0.15, 0, 0}}, {{0, 0, 0}});
  own.foretell(next);
  EXPECT_NEAR(next[0].x(), 1.20, 1e-12);
}

TEST(OwnMotion, ForetellsNothingOfWhatSnappedAndTheRestAsEver) {
  const Points still{{0, 0, 0}, {0, 0, 0}};
  OwnMotion own;
  own.frame_ended({{0.1, 0, 0}, {0.10, 0, 0}}, still);
  own.frame_ended({{0.6, 0, 0}, {0.12, 0, 0}}, still);
  Points next{{1, 2, 3}, {1, 2, 3}};
  own.foretell(next);
  EXPECT_EQ(next[0].x(), 1);
  EXPECT_NEAR(next[1].x(), 1.14, 1e-12);
}

// A tissue whose lower bone opens by half a degree a frame.
struct Opening {
  SyntheticSet set = make_synthetic_set(patient2_size());
  static Pose pose(int frame) { return synthetic_pose(0.0087 * (20 + frame), {0, 0, 0}); }

  /// Median of the iterations of the last frames, their factors made `ahead` at where they begin,
  /// or at where the frames before ended.
  int iterations(bool ahead) const {
    constexpr int frames = 13, last = 9;
    NetLoads loads = synthetic_loads(set, pose(-1));
    SpringPrismEnergy energy(set.net, loads, 2);
    MinimizeSettings settings;
    settings.tolerance_mm = 5e-3;
    Nodes x = set.rest;
    HessianFactor factor(set.net, loads, set.sheets, x, 2);
    minimize_refreshing(set.net, loads, energy, factor, settings, x);
    OwnMotion own;
    std::vector<int> used;
    for (int frame = 0; frame < frames; ++frame) {
      loads = synthetic_loads(set, pose(frame));
      const Nodes taken = carried(set, x, pose(frame - 1), pose(frame));
      Nodes next = taken;
      own.foretell(next);
      factor = factor.anew(set.net, loads, ahead ? next : x, 2);
      settings.fresh = ahead;
      const auto result = minimize(Method::preconditioned, energy, settings, next, &factor);
      EXPECT_TRUE(result.converged());
      used.push_back(result.iterations);
      own.frame_ended(next, taken);
      x = next;
    }
    std::nth_element(used.end() - last, used.end() - last / 2 - 1, used.end());
    return used[frames - last / 2 - 1];
  }
};

TEST(OwnMotion, AFactorOfWhereTheFrameBeginsNeedsOneStep) {
  const Opening opening;
  EXPECT_EQ(opening.iterations(true), 1);
  EXPECT_GE(opening.iterations(false), 2);
}

}  // namespace
}  // namespace condyle
