// Glued and sliding tissue both follow a whole opening, into nothing, and their lips differ.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "sim/tissue/lips.h"
#include "sim/tissue/tissue.h"
#include "tests/support/builtin.h"
#include "tests/support/jaw_pose.h"
#include "tests/support/scan_case.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

struct OpenedFace {
  int unconverged = 0, inverted = 0;
  double penetration_mm = 0, slip_mm = 0, error_mm = 0;
  std::vector<Eigen::Vector3f> half_open;
};

/// Rotated by 30 degrees about the condyles, which translate forward and down.
OpenedFace open_wide(const Case& patient, TissueBond bond) {
  constexpr int frames = 30;
  const auto model = build_tissue(patient, {.plan = {.bond = bond}});
  const Vector3d condyles =
      0.5 * (*patient.landmarks.find("left_condyle") + *patient.landmarks.find("right_condyle"));
  TissueState state = rest_tissue(*model);
  TissueWarmStart warm;
  OpenedFace seen;
  for (int i = 1; i <= frames; ++i) {
    const double degrees = 30.0 * i / frames, slide = 0.4 * std::max(0.0, degrees - 4);
    Pose X_CM;
    X_CM.R =
        Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vector3d::UnitX()));
    X_CM.t = condyles - X_CM.R * condyles + Vector3d(0, -slide, -0.5 * slide);
    state = solve_tissue(*model, state, jaw_at(X_CM), {}, warm);
    seen.unconverged += !state.converged || state.reused;
    seen.inverted += state.inverted_prisms;
    seen.penetration_mm = std::max(seen.penetration_mm, state.penetration_mm);
    seen.error_mm = std::max(seen.error_mm, state.contact_error_mm);
    seen.slip_mm = std::max(seen.slip_mm, state.slip_mm);
    if (i == frames / 2) deform_face(*model, state, seen.half_open);
  }
  return seen;
}

void expect_both_follow(Case patient) {
  part_lips(patient);
  const OpenedFace sliding = open_wide(patient, TissueBond::sliding);
  const OpenedFace glued = open_wide(patient, TissueBond::glued);
  for (const auto* seen : {&sliding, &glued}) {
    EXPECT_EQ(seen->unconverged, 0);
    EXPECT_EQ(seen->inverted, 0);
    EXPECT_LT(seen->penetration_mm, 0.2);
    EXPECT_LT(seen->error_mm, 0.1);
  }
  EXPECT_GT(sliding.slip_mm, 2);
  EXPECT_LT(glued.slip_mm, sliding.slip_mm);
  const auto& face = patient.find(Role::face)->mesh.vertices;
  const Vector3d stomion = *patient.landmarks.find("stomion");
  double apart = 0;
  for (std::size_t v = 0; v < face.size(); ++v)
    if ((face[v] - stomion).norm() < 15)
      apart =
          std::max(apart, static_cast<double>((sliding.half_open[v] - glued.half_open[v]).norm()));
  std::printf("lips apart by %.2f mm; slip %.2f sliding, %.2f mm glued\n", apart, sliding.slip_mm,
              glued.slip_mm);
  EXPECT_GT(apart, 0.5);
}

TEST(TissueBond, TissueDetachedFromABoneIsNotHeldByIt) {
  Case patient = builtin();
  part_lips(patient);
  const auto detached_from = [&](std::optional<BodyId> bone) {
    TissuePlan plan{.bond = TissueBond::glued};
    if (bone) plan.attachments = {{*bone, false, "stomion", Vector3d::Zero(), 25}};
    return summary(*build_tissue(patient, {.plan = plan}));
  };
  const TissueSummary whole = detached_from({}), no_jaw = detached_from(mandible_body),
                      no_skull = detached_from(cranium_body);
  EXPECT_LT(no_jaw.attached_to_mandible, whole.attached_to_mandible);
  EXPECT_EQ(no_jaw.attached_to_cranium, whole.attached_to_cranium);
  EXPECT_LT(no_skull.attached_to_cranium, whole.attached_to_cranium);
  EXPECT_EQ(no_skull.attached_to_mandible, whole.attached_to_mandible);
}

// The lower lip of a closed mouth lies on the upper teeth too, and does not stay with them.
TEST(TissueBond, GluedAndSlidingFollowTheBuiltInJawAndTheirLipsDiffer) {
  expect_both_follow(builtin());
}

TEST(TissueBond, GluedAndSlidingFollowARealJawAndTheirLipsDiffer) {
  const auto patient = case_badin_with_face();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  expect_both_follow(*patient);
}

}  // namespace
}  // namespace condyle::test
