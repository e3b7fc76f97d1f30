#include "tools/bench/baseline/rigid_scenes.h"

#include <gtest/gtest.h>

namespace condyle {
namespace {

// The scenes of the benchmark, held by the engine to its own tolerances; Bullet's answers differ,
// but it plays the same scene.
TEST(RigidScenes, AChainSwingsOnItsJoints) {
  const RigidRun own = swing_chain(RigidMethod::condyle), bullet = swing_chain(RigidMethod::bullet);
  EXPECT_EQ(own.step_ms.size(), bullet.step_ms.size());
  EXPECT_LT(own.joint_error_mm, 0.02);
  EXPECT_LT(own.energy_gain, 0.02);
  EXPECT_LT(own.energy_loss, 0.05);
  EXPECT_LT(bullet.joint_error_mm, 1);
  EXPECT_LT(bullet.energy_gain, 0.5);
}

TEST(RigidScenes, ABlockIsHeldAndSlidesByCoulombsLaw) {
  const RigidRun own = slide_block(RigidMethod::condyle), bullet = slide_block(RigidMethod::bullet);
  EXPECT_LT(own.depth_mm, 0.03);  // the slop and the tolerated depth beyond it
  EXPECT_LT(own.drift_mm, 0.01);
  EXPECT_LT(own.slide_error, 0.02);
  EXPECT_LT(bullet.drift_mm, 10);
  EXPECT_LT(bullet.slide_error, 0.5);
}

}  // namespace
}  // namespace condyle
