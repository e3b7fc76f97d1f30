// What must hold of bodies that a hand drags about, as the simulator moves them: they end at the
// same place by any route, rest where the hand rests, and do not overlap.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "engine/mesh/measure.h"
#include "sim/contact/contact.h"
#include "tests/support/boxes.h"
#include "tests/support/builtin.h"
#include "tests/support/overlap_oracle.h"
#include "tests/support/real_cases.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using test::builtin;
using test::shift;
using Targets = std::vector<Pose>;  // X_PB
using test::target_poses;

const ContactModel& builtin_model() {
  static const ContactModel model(builtin());
  return model;
}

std::size_t part_of(const Case& patient, Role role) {
  return static_cast<std::size_t>(patient.find(role) - patient.parts.data());
}

/// Largest distance of a corner of the part's box between two poses.
double apart(const TriMesh& mesh, const Pose& a, const Pose& b) {
  const Box box = bounding_box(mesh);
  double most = 0;
  for (int i = 0; i < 8; ++i) {
    const Vector3d p((i & 1 ? box.low : box.high).x(), (i & 2 ? box.low : box.high).y(),
                     (i & 4 ? box.low : box.high).z());
    most = std::max(most, (a * p - b * p).norm());
  }
  return most;
}

/// Two parts whose overlap is measured independently, and the body that is dragged.
struct Drag {
  const Case& patient;
  const ContactModel& model;
  std::size_t still, moving;
  double allowed_mm = 0;  // overlap at rest
  Targets outside = target_poses(shift(0, 0, -8));

  Pose pose(const BodyPoses& at) const { return pose_of(patient.parts[moving], at); }
};

/// Drags in `frames` steps; every few frames the same target is sought in one jump from rest and
/// from outside, and in three steps along another path.
template <class TargetAt>
int expect_lawful(const Drag& drag, int frames, const TargetAt& target_at) {
  const TriMesh& mesh = drag.patient.parts[drag.moving].mesh;
  const test::OverlapOracle still(drag.patient.parts[drag.still].mesh), moving(mesh);
  const BodyPoses rest = drag.model.placed({});
  BodyPoses at = rest;
  ContactSet last = drag.model.at_rest();
  std::vector<double> depths;
  int held = 0;
  for (int f = 0; f < frames; ++f) {
    const Targets target = target_at(static_cast<double>(f) / (frames - 1));
    const auto slide = drag.model.slide(at, target, &last, 2);
    at = slide.at;
    last = slide.contacts;
    EXPECT_LE(last.max_penetration_mm(), 0.02) << f;
    if (!slide.stopped) continue;
    if (++held % 3 != 1) continue;
    const Pose X = drag.pose(at);
    depths.push_back(
        deepest(still, moving, pose_of(drag.patient.parts[drag.still], at).inverse() * X));
    const auto expect_here = [&](const ContactModel::Slide& other, const char* route) {
      EXPECT_LE(apart(mesh, drag.pose(other.at), X), 0.05) << f << " " << route;
    };
    const auto again = drag.model.slide(at, target, &last, 1);
    EXPECT_LE(apart(mesh, drag.pose(again.at), X), 0.02) << f << " at rest";
    expect_here(drag.model.slide(rest, target, nullptr, 2), "from rest");
    const BodyPoses open = drag.model.placed(drag.outside);
    expect_here(drag.model.slide(open, target, nullptr, 2), "from outside");
    BodyPoses other = open;
    for (const double back : {-0.2, -0.1, 0.0}) {
      const double s = std::clamp(static_cast<double>(f) / (frames - 1) + back, 0.0, 1.0);
      other = drag.model.slide(other, target_at(s), nullptr, 2).at;
    }
    expect_here(drag.model.slide(other, target, nullptr, 2), "by another route");
  }
  std::sort(depths.begin(), depths.end());
  EXPECT_GE(depths.size(), 3u);
  if (!depths.empty()) {
    EXPECT_LE(depths.back(), drag.allowed_mm + 0.1);
    EXPECT_LE(depths[depths.size() / 2], drag.allowed_mm + 0.05);
  }
  return held;
}

Drag teeth() {
  return {builtin(), builtin_model(), part_of(builtin(), Role::upper_teeth),
          part_of(builtin(), Role::lower_teeth)};
}

Drag bones() {
  return {builtin(), builtin_model(), part_of(builtin(), Role::skull),
          part_of(builtin(), Role::mandible)};
}

constexpr double round_trip = 2 * std::numbers::pi;

TEST(DragLaws, TeethGrindInTheirBite) {
  const Vector3d condyles(0, 30, 75);
  const int held = expect_lawful(teeth(), 25, [&](double s) {
    Pose X;
    X.R =
        Eigen::AngleAxisd(0.03 * std::sin(2 * round_trip * s), Vector3d(0.3, 0.2, 1).normalized());
    X.t = Vector3d(3 * std::sin(round_trip * s), 2 * std::sin(2 * round_trip * s), 0.6) + condyles -
          X.R * condyles;
    return target_poses(X);
  });
  EXPECT_GE(held, 20);
}

TEST(DragLaws, TheJawCirclesInItsBite) {
  EXPECT_GE(expect_lawful(teeth(), 16,
                          [](double s) {
                            return target_poses(shift(2.5 * std::sin(round_trip * s),
                                                      0.5 * std::sin(2 * round_trip * s), 1.5));
                          }),
            14);
}

TEST(DragLaws, TheJawIsPushedUpAndLowered) {
  EXPECT_GE(expect_lawful(
                teeth(), 20,
                [](double s) { return target_poses(shift(0.5, 0, 6 * std::sin(round_trip * s))); }),
            8);
}

TEST(DragLaws, CondylesGlideOnTheEminence) {
  // Opened, forward, and pressed up.
  const Vector3d condyles(0, 30, 75);
  EXPECT_GE(expect_lawful(bones(), 10,
                          [&](double s) {
                            Pose X;
                            X.R = Eigen::AngleAxisd(0.2 + 0.1 * s, Vector3d::UnitX());
                            X.t = condyles - X.R * condyles + Vector3d(0, -12 * s, 4 - 4 * s);
                            return target_poses(X);
                          }),
            7);
}

TEST(DragLaws, AGraftIsDraggedAlongTheMandible) {
  Case patient = builtin();
  const Vector3d chin = *patient.landmarks.find("pogonion");
  const Vector3d low = chin + Vector3d(-8, -14, -3);
  patient.add_piece({"graft", Role::transplant, test::box(low, low + Vector3d(16, 6, 6)), {}},
                    mandible_body);
  const ContactModel model(patient);
  const Drag drag{patient,
                  model,
                  part_of(patient, Role::mandible),
                  patient.parts.size() - 1,
                  0,
                  target_poses({}, {shift(0, -5, 0)})};
  EXPECT_GE(expect_lawful(drag, 10,
                          [](double s) {
                            Pose X = shift(20 * s - 10, 12, 3 * std::sin(5 * s));
                            return target_poses({}, {X});
                          }),
            7);
}

TEST(DragLaws, AJawThatMovesNextToASegmentThatWasMovedSlidesOnIt) {
  Case patient = test::two_bones(test::box({-30, -30, 12}, {30, 30, 20}), test::sphere(4, 10));
  patient.add_piece({"segment", Role::segment, test::box({30, -30, -20}, {40, 30, 10}), {}},
                    cranium_body);
  const ContactModel model(patient);
  const Pose moved = shift(-15, 0, 0);  // its wall is now at x = 15
  ContactSet last = model.at_rest();
  BodyPoses at = model.slide(BodyPoses{}, target_poses({}, {moved}), &last).at;
  for (int k = 1; k <= 20; ++k) {
    const auto slide = model.slide(at, target_poses(shift(0.5 * k, 0.4 * k, 0), {moved}), nullptr);
    at = slide.at;
    EXPECT_EQ(at[BodyId{2}].t, moved.t);
    EXPECT_LE(slide.contacts.max_penetration_mm(), 0.02);
    EXPECT_NEAR(at[mandible_body].t.x(), std::min(0.5 * k, 5.0), 0.05);
    EXPECT_NEAR(at[mandible_body].t.y(), 0.4 * k, 0.05);
  }
  const auto jump = model.slide(model.placed(target_poses({}, {moved})),
                                target_poses(shift(10, 8, 0), {moved}), nullptr);
  EXPECT_LE((jump.at[mandible_body].t - at[mandible_body].t).norm(), 0.05);
}

TEST(DragLaws, WallsAsThinAsEachOtherAreNotPassed) {
  // Two plates, thinner than any field's spacing, edge on and face on.
  const TriMesh plate = test::box({-20, -20, 30}, {20, 20, 30.2});
  for (const TriMesh& mover :
       {test::box({-15, -15, 0}, {15, 15, 0.2}), test::box({-0.1, -15, -10}, {0.1, 15, 0.2})}) {
    const ContactModel model(test::two_bones(plate, mover));
    const auto slide = model.slide(Pose{}, target_poses(shift(0, 0, 45)), nullptr);
    EXPECT_TRUE(slide.stopped);
    EXPECT_NEAR(slide.at[mandible_body].t.z(), 29.8, 0.05);
  }
}

TEST(DragLaws, BadinSlidesOnWhereItMeetsBone) {
  const auto patient = test::case_badin();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const ContactModel model(*patient);
  EXPECT_GE(expect_lawful({*patient, model, 0, 1}, 24,
                          [](double s) { return target_poses(shift(0, 2 * s, 10 * s)); }),
            12);
}

TEST(DragLaws, UbcCrownsThatOverlapAtRestSeparateSidewaysAndReturn) {
  const auto patient = test::case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const ContactModel model(*patient);
  BodyPoses at = model.placed({});
  ContactSet last = model.at_rest();
  const auto go = [&](double x, double z) {
    const auto slide = model.slide(at, target_poses(shift(x, 0, z)), &last, 2);
    at = slide.at;
    last = slide.contacts;
    EXPECT_LE(last.max_penetration_mm(), 0.02) << x << " " << z;
    return at[mandible_body].t;
  };
  EXPECT_EQ(go(0, -2), Vector3d(0, 0, -2));  // straight out
  EXPECT_LE(go(0, 0).norm(), 0.05);          // and back
  EXPECT_LE(go(0, 0.4).norm(), 0.05);        // no deeper
  EXPECT_LE(go(0.5, 0).norm(), 0.6);         // held
  const Vector3d beside = go(4, 0);
  EXPECT_GT(beside.x(), 2);
  EXPECT_LT(beside.z(), -1);  // on the slopes of the cusps, overlapping no more
  const auto jump = model.slide(shift(0, 0, -8), target_poses(shift(4, 0, 0)), nullptr, 2);
  EXPECT_LE((jump.at[mandible_body].t - beside).norm(), 0.05);
  EXPECT_LE(go(0, 0).norm(), 0.05);
}

}  // namespace
}  // namespace condyle
