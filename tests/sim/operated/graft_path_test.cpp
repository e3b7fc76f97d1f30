// The insertion path of a graft as a motion, and its release onto the bone.
#include "sim/operated/graft_path.h"

#include <gtest/gtest.h>

#include "engine/core/error.h"
#include "sim/dynamics/release_body.h"
#include "sim/operated/operated_scene.h"
#include "tests/support/boxes.h"
#include "tests/support/builtin.h"
#include "tests/support/reconstruction.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The jaw from the right canine to the left first molar replaced by a fibula in three pieces.
Plan fibula_plan() {
  return with_step(test::resection_plan(test::builtin(), 43, 36), test::fibula_graft(3));
}

const OperatedPatient& operated() {
  static const OperatedPatient patient = operate(test::builtin(), fibula_plan());
  return patient;
}

/// A plate that must tilt under an overhang; see insertion_path_test.cpp.
Scene overhang() {
  Case patient;
  patient.name = "overhang";
  const auto add = [&](const char* name, const TriMesh& mesh, Role role = Role::segment) {
    patient.add_piece({name, role, mesh, {}}, mandible_body);
  };
  patient.parts.push_back({"skull", Role::skull, test::box({-60, -60, 8}, {60, 60, 40}), {}});
  patient.parts.push_back({"mandible", Role::mandible, test::box({-60, 21, -12}, {60, 60, 4}), {}});
  add("lip", test::box({-60, -60, -8}, {60, -14, -4}));
  add("left", test::box({11, -20, -12}, {60, 20, 4}));
  add("right", test::box({-60, -20, -12}, {-11, 20, 4}));
  add("rear", test::box({-60, -60, -3}, {60, -28, 7}));
  add("plate", test::box({-10, -20, -3}, {10, 20, 3}), Role::transplant);
  ContactModel contacts(patient);
  ScenePlan plan{.name = "overhang", .hash = ""};
  plan.seats.push_back(
      {.name = "plate", .bodies = {"plate"}, .face_normals = {}, .approach = {0, 0, -1}});
  return {std::move(patient), std::move(contacts), nullptr, std::move(plan)};
}

}  // namespace

TEST(GraftPath, OfTheBuiltInFibulaIsStraightAndFree) {
  const auto& seats = operated().plan.seats;
  ASSERT_EQ(seats.size(), 1u);
  EXPECT_EQ(seats[0].bodies.size(), 3u);
  const InsertionPath path = find_insertion_path(operated().patient, seats[0], 2);
  EXPECT_EQ(path.state, InsertionPath::State::free);
  EXPECT_FALSE(path.turns());
  EXPECT_EQ(path.poses_examined, 0);  // nothing was searched
  EXPECT_NEAR(path.margin_mm, 1.24, 0.005);
  EXPECT_EQ(path.margin_part, "mandible");
}

TEST(GraftPath, WithTurnsIsPlayedWithContactOutOfTheSeatAndBack) {
  const Scene scene = overhang();
  const Motion motion = insertion_path_motion("path:plate", scene, 3, 2);
  ASSERT_EQ(motion.notes.size(), 1u);
  EXPECT_NE(motion.notes[0].find("turned by up to"), std::string::npos) << motion.notes[0];
  const BodyId body = *scene.patient.bodies.find("plate");
  const auto target = [&](double time_s) { return motion.pieces(time_s)[index_of(body)]; };
  EXPECT_TRUE(target(0).t.isZero());
  EXPECT_NEAR(target(1.5).t.norm(), path_length_mm, 0.2);
  EXPECT_TRUE(target(0.4).t.isApprox(target(2.6).t, 1e-9));
  SimulatorSettings settings;
  settings.tissue = false;
  settings.step_s = 1. / 60;
  Playback playback(scene, motion, settings);
  double turned = 0;
  for (int i = 0; i <= 36; ++i) {
    const double time_s = motion.duration_s * i / 36;
    const FrameState frame = playback.at(time_s);
    const Pose &X = frame.poses[body], aim = target(time_s);
    turned = std::max(turned, rotation_angle(X));
    // Contact does not hold it back anywhere.
    for (const Vector3d& p : {Vector3d(10, 20, 3), Vector3d(-10, -20, -3)})
      EXPECT_LT((X * p - aim * p).norm(), 0.15) << time_s;
  }
  EXPECT_GT(turned, 0.1);
}

TEST(GraftPath, OfAnUnknownGraftIsRefused) {
  const Scene scene = overhang();
  EXPECT_THROW(insertion_path_motion("path:plaet", scene, 3, 1), InputError);
}

TEST(GraftPath, AGraftThatIsReleasedSettlesOnTheBoneAsOneBody) {
  const Case& patient = operated().patient;
  const Seat& seat = operated().plan.seats[0];
  const BodyId first = *patient.bodies.find("fibula_1"), last = *patient.bodies.find("fibula_3");
  // Pushed against the first face of the jaw, which is 0.2 mm away.
  const Release settled =
      release_body(patient, first, {}, {.push_N = -5 * seat.face_normals[0]}, 2);
  ASSERT_TRUE(settled.rest.reached);
  EXPECT_LT(settled.rest.depth_mm, 0.05);
  ASSERT_GE(settled.contacts.size(), 3u);
  Vector3d push = Vector3d::Zero();
  for (const ReleaseContact& contact : settled.contacts) {
    EXPECT_EQ(patient.parts[static_cast<std::size_t>(contact.part)].role, Role::mandible);
    push += contact.push_N * contact.normal;
  }
  EXPECT_NEAR(push.dot(seat.face_normals[0]), 5, 2);  // the rest is friction's
  const Pose& X = settled.poses[first];
  const double moved = (X * Vector3d(0, -80, -80) - Vector3d(0, -80, -80)).norm();
  EXPECT_GT(moved, 0.05);
  EXPECT_LT(moved, 2);
  EXPECT_TRUE(bit_identical(settled.poses[last], X));  // pieces stay together
}

}  // namespace condyle
