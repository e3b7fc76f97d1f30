#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "engine/collide/collision_mesh.h"
#include "engine/collide/slide.h"
#include "tests/support/overlap_oracle.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

const TriMesh& surface(const Case& patient, Role role) {
  for (const auto& part : patient.parts)
    if (part.role == role) return part.mesh;
  throw std::runtime_error("no such part");
}

/// Closes from 6 mm below and grinds sideways, to and fro, turning about the vertical, while it
/// presses the arches up to 0.8 mm past their bite.
Pose wanted_at(double s) {
  const Vector3d condyles(0, 30, 75);
  const double round = 2 * std::numbers::pi * s;
  Pose X;
  X.R = Eigen::AngleAxisd(0.03 * std::sin(5 * round), Vector3d(0.3, 0.2, 1).normalized());
  const double closing = std::min(1.0, 10 * s);
  const double press = s > 0.1 ? 0.4 * (1 - std::cos(6 * round)) : 0;
  X.t = Vector3d(3 * std::sin(3 * round), 2 * std::sin(2 * round + 1) - 2 * std::sin(1.0),
                 6 * closing - 6 + press) +
        condyles - X.R * condyles;
  return X;
}

/// The lower crowns against the upper ones.
SlidingContact arches(const Case& patient) {
  const auto body = [&](Role role) {
    return std::make_shared<const SlideBody>(make_slide_body(surface(patient, role), {}, 2));
  };
  return SlidingContact({body(Role::upper_teeth)}, {body(Role::lower_teeth)});
}

TEST(Grinding, CrownsSlideOnCrownsWithoutOverlap) {
  const auto patient = test::case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const TriMesh &upper = surface(*patient, Role::upper_teeth),
                &lower = surface(*patient, Role::lower_teeth);
  const SlidingContact model = arches(*patient);
  const CollisionMesh upper_mesh(upper), lower_mesh(lower);
  const test::OverlapOracle upper_oracle(upper), lower_oracle(lower);

  SlideMemory memory;
  Pose X{Eigen::Quaterniond::Identity(), {0, 0, -6}};
  std::vector<double> depths;
  constexpr int frames = 330;
  for (int f = 0; f < frames; ++f) {
    const Pose wanted = wanted_at(static_cast<double>(f) / frames);
    const SlideResult result = model.slide(X, wanted, &memory);
    X = result.X_FM;
    if (contacts(upper_mesh, {}, lower_mesh, wanted).size() < 50) continue;
    EXPECT_TRUE(result.touching);
    depths.push_back(deepest(upper_oracle, lower_oracle, X));
    // At rest it stays.
    EXPECT_EQ(model.slide(X, wanted, &memory).X_FM.t, X.t);
  }
  ASSERT_GE(depths.size(), 300u);
  std::sort(depths.begin(), depths.end());
  EXPECT_LE(depths.back(), 0.1);
  EXPECT_LE(depths[depths.size() / 2], 0.05);
}

TEST(Grinding, ArchesDoNotPassThroughEachOtherInOneJump) {
  const auto patient = test::case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const TriMesh &upper = surface(*patient, Role::upper_teeth),
                &lower = surface(*patient, Role::lower_teeth);
  const SlidingContact model = arches(*patient);
  const Pose open{Eigen::Quaterniond::Identity(), {0, 0, -25}};
  const SlideResult result = model.slide(open, {Eigen::Quaterniond::Identity(), {1, 1, 20}});
  EXPECT_TRUE(result.touching);
  EXPECT_LT(result.X_FM.t.z(), 0.5);
  EXPECT_GT(result.X_FM.t.z(), -4);
  const test::OverlapOracle upper_oracle(upper), lower_oracle(lower);
  EXPECT_LE(deepest(upper_oracle, lower_oracle, result.X_FM), 0.1);
}

}  // namespace
}  // namespace condyle
