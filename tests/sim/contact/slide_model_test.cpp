// Bodies whose targets are obstructed slide to the nearest pose, verified by the exact surfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "sim/contact/contact.h"
#include "sim/contact/push_out_parts.h"
#include "tests/support/boxes.h"
#include "tests/support/overlap_oracle.h"
#include "tests/support/real_cases.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

using test::shift;
using test::two_bones;

/// A ball under a block whose underside is at z = 12.
Case ball_under_block() {
  return two_bones(test::box({-30, -30, 12}, {30, 30, 20}), test::sphere(4, 10));
}

TEST(Slide, AnObstructedTargetSlidesAlong) {
  const ContactModel model(ball_under_block());
  Pose X;
  ContactSet last = model.at_rest();
  int held = 0;
  for (int k = 1; k <= 40; ++k) {
    const auto slide = model.slide(X, test::target_poses(shift(0.3 * k, 0, 0.1 * k)), &last);
    X = slide.at[mandible_body];
    last = slide.contacts;
    EXPECT_LE(last.max_penetration_mm(), 0.02);
    // A ball on a plane: a path along it is completed, a path into it ends at the surface.
    EXPECT_NEAR(X.t.x(), 0.3 * k, 0.05);
    EXPECT_NEAR(X.t.z(), std::min(0.1 * k, 2.0), 0.05);
    held += slide.stopped;
  }
  EXPECT_GT(held, 15);
  EXPECT_LT(held, 25);
}

TEST(Slide, FarSurfacesMayBeBoundedAndNothingElseChanges) {
  const Case patient = ball_under_block();
  const ContactModel model(patient);
  Pose X, X_measured;
  ContactSet last = model.at_rest(), last_measured = model.at_rest();
  int bounds = 0, held = 0;
  for (int k = 0; k <= 120; ++k) {  // far down and up again, until it is held
    const Pose target = shift(0.1 * k, 0, 3 - 15 * std::sin(std::numbers::pi * k / 60));
    const bool bound_far = k % 4 != 0;  // as a window, which shows some steps
    const auto slide = model.slide(X, test::target_poses(target), &last, 1, bound_far);
    const auto measured = model.slide(X_measured, test::target_poses(target), &last_measured);
    EXPECT_EQ(slide.at[mandible_body].t, measured.at[mandible_body].t) << k;
    EXPECT_EQ(slide.stopped, measured.stopped) << k;
    for (std::size_t i = 0; i < slide.contacts.pairs.size(); ++i) {
      const PairContact &pair = slide.contacts.pairs[i], &exact = measured.contacts.pairs[i];
      EXPECT_FALSE(exact.distance_is_bound);
      bounds += pair.distance_is_bound;
      EXPECT_TRUE(bound_far || !pair.distance_is_bound);
      if (!pair.distance_is_bound) {
        EXPECT_EQ(pair.distance_mm, exact.distance_mm) << k;
        continue;
      }
      EXPECT_GE(pair.distance_mm, 5);
      EXPECT_LE(pair.distance_mm, exact.distance_mm + 1e-9) << k;
    }
    X = slide.at[mandible_body];
    last = slide.contacts;
    X_measured = measured.at[mandible_body];
    last_measured = measured.contacts;
    held += slide.stopped;
  }
  EXPECT_GT(bounds, 20);
  EXPECT_GT(held, 10);
}

TEST(Slide, BoundedDistancesAreMeasuredWhereNothingMoves) {
  Case patient = two_bones(test::box({-30, -30, 20}, {30, 30, 30}), test::sphere(3, 10));
  patient.add_piece({"segment", Role::segment, test::box({-3, -3, 12}, {3, 3, 13}), {}},
                    cranium_body);
  const ContactModel model(patient);
  const std::vector<Pose> target{shift(0.5, 0, 0)};
  const auto moved = model.slide(Pose{}, test::target_poses({}, target), &model.at_rest(), 1, true);
  const auto bounds = [](const ContactSet& set) {
    return std::count_if(set.pairs.begin(), set.pairs.end(),
                         [](const PairContact& pair) { return pair.distance_is_bound; });
  };
  EXPECT_GT(bounds(moved.contacts), 0);
  const auto still = model.slide(moved.at, test::target_poses({}, target), &moved.contacts);
  EXPECT_EQ(bounds(still.contacts), 0);
  const ContactSet anew = model.find(moved.at, nullptr);
  for (std::size_t i = 0; i < anew.pairs.size(); ++i)
    EXPECT_EQ(still.contacts.pairs[i].distance_mm, anew.pairs[i].distance_mm);
}

TEST(Slide, WithoutContactThePoseIsExactlyTheTarget) {
  const ContactModel model(ball_under_block());
  std::mt19937_64 random(3);
  for (int k = 0; k < 20; ++k) {
    Pose target = test::any_pose(random, 0.6);
    target.R = Eigen::Quaterniond::Identity().slerp(0.1, target.R);
    const auto slide = model.slide(Pose{}, test::target_poses(target), nullptr);
    EXPECT_FALSE(slide.stopped);
    EXPECT_EQ(slide.at[mandible_body].t, target.t);
    EXPECT_EQ(slide.at[mandible_body].R.coeffs(), target.R.coeffs());
  }
}

TEST(Slide, AJumpDoesNotPassThroughAThinWall) {
  const ContactModel model(
      two_bones(test::box({-40, -40, 30}, {40, 40, 30.3}), test::sphere(3, 10)));
  for (const double jump : {22.0, 45.0}) {
    const auto slide = model.slide(Pose{}, test::target_poses(shift(0, 0, jump)), nullptr);
    EXPECT_TRUE(slide.stopped);
    EXPECT_NEAR(slide.at[mandible_body].t.z(), 20, 0.05);
    EXPECT_LE(slide.contacts.max_penetration_mm(), 0.02);
  }
}

TEST(Slide, OpenShellsAreSlidOnAndNotPassedThrough) {
  TriMesh sheet;  // one layer, no inside
  sheet.vertices = {{-30, -30, 30}, {30, -30, 30}, {30, 30, 30}, {-30, 30, 30}};
  sheet.triangles = {{0, 2, 1}, {0, 3, 2}};  // faces down
  for (const bool turned : {false, true}) {
    if (turned)
      for (auto& t : sheet.triangles) std::swap(t[1], t[2]);
    const ContactModel model(two_bones(sheet, test::sphere(3, 10)));
    const auto jump = model.slide(Pose{}, test::target_poses(shift(0, 0, 45)), nullptr);
    EXPECT_TRUE(jump.stopped);
    EXPECT_NEAR(jump.at[mandible_body].t.z(), 20, 0.05);
    Pose X = jump.at[mandible_body];
    ContactSet last = jump.contacts;
    for (int k = 1; k <= 10; ++k) {
      const auto slide = model.slide(X, test::target_poses(shift(0.5 * k, 0, 21)), &last);
      X = slide.at[mandible_body];
      last = slide.contacts;
      EXPECT_LE(X.t.z(), 20.05);
    }
    if (!turned) {
      EXPECT_NEAR(X.t.x(), 5, 0.1);
    }
  }
}

TEST(Slide, AFixedTargetGivesAFixedPose) {
  const ContactModel model(ball_under_block());
  Pose X;
  ContactSet last = model.at_rest();
  const Pose target{Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Vector3d(1, 2, 0).normalized())),
                    {3, 1, 6}};
  for (int k = 0; k < 30; ++k) {
    const auto slide = model.slide(X, test::target_poses(target), &last);
    if (k > 1) {
      EXPECT_LE((slide.at[mandible_body].t - X.t).norm(), 0.02);
    }
    X = slide.at[mandible_body];
    last = slide.contacts;
  }
}

TEST(Slide, AGuidedPairKeepsItsGap) {
  Case patient = ball_under_block();
  patient.pair_rules = {{"maxilla", "mandible", PairPolicy::guided, {}, 1.5}};
  const ContactModel model(patient);
  EXPECT_EQ(model.at_rest().pairs[0].policy, PairPolicy::guided);
  const auto slide = model.slide(Pose{}, test::target_poses(shift(4, 0, 5)), nullptr);
  EXPECT_TRUE(slide.stopped);
  EXPECT_NEAR(slide.contacts.pairs[0].distance_mm, 1.5, 0.03);
  EXPECT_NEAR(slide.at[mandible_body].t.x(), 4, 0.05);
  // Nearer at rest than its gap: it keeps the rest distance.
  patient.pair_rules[0].gap_mm = 3;
  const auto closer =
      ContactModel(patient).slide(Pose{}, test::target_poses(shift(4, 0, 5)), nullptr);
  EXPECT_GE(closer.contacts.pairs[0].distance_mm, model.at_rest().pairs[0].distance_mm - 0.03);
}

TEST(Slide, OverlapAtRestIsNotDeepened) {
  // The ball sits 1.2 mm deep in the block.
  const ContactModel model(
      two_bones(test::box({-30, -30, 10}, {30, 30, 40}), test::sphere(4, 10, {0, 0, 1.2})));
  for (const double up : {0.1, 3.0, 45.0}) {
    const auto slide = model.slide(Pose{}, test::target_poses(shift(0, 0, up)), &model.at_rest());
    EXPECT_TRUE(slide.stopped);
    EXPECT_LE(slide.contacts.max_penetration_mm(), 0.02);
  }
  EXPECT_FALSE(model.slide(Pose{}, test::target_poses(shift(0, 0, -20)), &model.at_rest()).stopped);
}

TEST(Slide, PosesThatAreNoNumbersAreRefused) {
  const ContactModel model(ball_under_block());
  const double nan = std::nan("");
  EXPECT_THROW(model.slide(Pose{}, test::target_poses(shift(nan, 0, 0)), nullptr), InputError);
  EXPECT_THROW(model.slide(shift(0, nan, 0), test::target_poses(Pose{}), nullptr), InputError);
  EXPECT_THROW(model.find(shift(0, 0, nan), nullptr), InputError);
  Pose flat;
  flat.R.coeffs().setZero();
  EXPECT_THROW(model.find(flat, nullptr), InputError);
}

TEST(Slide, OneAndTwoThreadsAreBitIdentical) {
  const ContactModel model(
      two_bones(test::sphere(4, 20, {0, 0, 0}, 0.05), test::sphere(4, 10, {0, 0, -31}, 0.05)));
  std::mt19937_64 random(6);
  Pose X;
  ContactSet last = model.at_rest();
  int held = 0;
  for (int k = 0; k < 15; ++k) {
    Pose target = test::any_pose(random, 5);
    target.R = Eigen::Quaterniond::Identity().slerp(0.05, target.R);
    const auto one = model.slide(X, test::target_poses(target), &last, 1),
               two = model.slide(X, test::target_poses(target), &last, 2);
    EXPECT_EQ(one.at[mandible_body].t, two.at[mandible_body].t);
    EXPECT_EQ(one.at[mandible_body].R.coeffs(), two.at[mandible_body].R.coeffs());
    EXPECT_EQ(one.contacts.pairs[0].depth_mm, two.contacts.pairs[0].depth_mm);
    held += one.stopped;
    X = one.at[mandible_body];
    last = one.contacts;
  }
  EXPECT_GT(held, 0);
}

TEST(Depenetration, AFreePartThatStartsDeepIsNotedAndCanBeMovedOut) {
  Case patient = ball_under_block();
  patient.add_piece({"segment", Role::segment, test::box({8, -3, -3}, {14, 3, 3}), {}},
                    cranium_body);
  const ContactModel deep(patient);
  const auto reported = [](const ContactModel& model, const char* words) {
    int count = 0;
    for (const auto& note : model.notes()) count += note.find(words) != std::string::npos;
    return count;
  };
  EXPECT_EQ(reported(deep, "segment starts"), 1);
  EXPECT_EQ(reported(deep, "--push-out"), 1);
  push_out_pieces(patient);
  ASSERT_EQ(patient.notes.size(), 1u);
  const ContactModel out(patient);
  EXPECT_EQ(reported(out, "segment starts"), 0);
  EXPECT_EQ(out.at_rest().max_penetration_mm(), 0);
  for (const auto& pair : out.at_rest().pairs) EXPECT_LE(pair.depth_mm, 0.02);
  EXPECT_NEAR(bounding_box(patient.parts[2].mesh).center().norm(), 13, 0.6);  // some 2 mm outward
}

TEST(Depenetration, ASegmentBetweenTwoBonesLeavesBoth) {
  // Out of either bone alone the exit leads into the other, 1 mm beyond.
  Case patient = test::box_patient();
  patient.add_piece({"segment", Role::segment, test::box({-5, -60, -52}, {5, -50, -42}), {}},
                    cranium_body);
  push_out_pieces(patient);
  ASSERT_EQ(patient.notes.size(), 1u);
  EXPECT_NE(patient.notes[0].find("was moved out"), std::string::npos) << patient.notes[0];
  const ContactModel model(patient);
  EXPECT_EQ(model.at_rest().max_penetration_mm(), 0);
  for (const auto& pair : model.at_rest().pairs) EXPECT_LE(pair.depth_mm, 0.02);
}

TEST(SlideRealAnatomy, BadinDrivenUpSlidesOn) {
  const auto patient = test::case_badin();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const ContactModel model(*patient);
  const test::OverlapOracle maxilla(patient->parts[0].mesh), mandible(patient->parts[1].mesh);
  Pose X;
  ContactSet last = model.at_rest();
  int held = 0;
  double moved_mm = 0;
  for (int k = 1; k <= 60; ++k) {
    const auto slide = model.slide(X, test::target_poses(shift(0, 0, 10.0 * k / 60)), &last, 2);
    if (slide.stopped) {
      ++held;
      moved_mm += (slide.at[mandible_body].t - X.t).norm();
      EXPECT_LE(deepest(maxilla, mandible, slide.at[mandible_body]), 0.1) << k;
    }
    X = slide.at[mandible_body];
    last = slide.contacts;
    EXPECT_LE(last.max_penetration_mm(), 0.02) << k;
  }
  EXPECT_GT(held, 30);
  EXPECT_GT(moved_mm, 2);  // it continues from where it first met bone
}

}  // namespace
}  // namespace condyle
