// A hand that drags bodies about: they slide, and never lie deeper in each other than allowed.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>

#include "engine/core/error.h"
#include "sim/phantom/phantom.h"
#include "sim/simulator/live.h"
#include "tests/sim/simulator/resting.h"
#include "tests/support/boxes.h"
#include "tests/support/overlap_oracle.h"

namespace condyle::test {
namespace {

std::size_t part_named(const Case& patient, const std::string& name) {
  for (std::size_t i = 0; i < patient.parts.size(); ++i)
    if (patient.parts[i].name == name) return i;
  throw std::runtime_error("no part " + name);
}

/// The next frame; the limit is for a hang, also under sanitizers.
FrameState next_frame(LiveSimulation& live) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(20);
  while (std::chrono::steady_clock::now() < end)
    if (auto frame = live.take()) return *frame;
  throw std::runtime_error("no frame came");
}

SimulatorSettings without_tissue() {
  SimulatorSettings settings;
  settings.tissue = false;
  return settings;
}

/// Skips the frames of the start: later frames respond to the hand, one for each move.
void await_start(LiveSimulation& live) {
  live.request({.time_s = 0.5, .face = false});
  while (next_frame(live).time_s != 0.5) {
  }
}

/// The boxes with a block that lies on top of the mandible's front and moves with it, and a segment
/// in the air.
Case box_patient_with_free_parts() {
  Case patient = box_patient();
  patient.add_piece({"transplant", Role::transplant, box({-5, -35, -40.8}, {5, -25, -30.8}), {}},
                    mandible_body);
  patient.add_piece({"segment", Role::segment, box({35, -70, -30}, {43, -62, -22}), {}},
                    cranium_body);
  return patient;
}

}  // namespace

TEST(Drag, TheJawOfTheBuiltInPatientSlidesInItsBite) {
  const Scene scene = make_scene(builtin_patient(), without_tissue());
  const auto& parts = scene.patient.parts;
  constexpr BodyId jaw = mandible_body;
  const std::size_t upper = part_named(scene.patient, "upper_teeth"),
                    lower = part_named(scene.patient, "lower_teeth");
  const OverlapOracle upper_oracle(parts[upper].mesh), lower_oracle(parts[lower].mesh);
  LiveSimulation live(scene, resting(), without_tissue());
  await_start(live);
  int touching = 0;
  double sideways = 0;
  for (int k = 0; k <= 24; ++k) {
    const double s = 2 * std::numbers::pi * k / 24;
    live.drag(jaw, shift(2.5 * std::sin(s), 0.5 * std::sin(2 * s), 1.5));
    const FrameState frame = next_frame(live);
    EXPECT_TRUE(frame.stopped);
    EXPECT_LE(frame.contacts.max_penetration_mm(), 0.02) << k;
    if (k % 4 == 0) {
      EXPECT_LE(deepest(upper_oracle, lower_oracle, frame.poses[mandible_body]), 0.1) << k;
    }
    touching += frame.contacts.contact_count() > 0;
    sideways = std::max(sideways, std::abs(frame.poses[mandible_body].t.x()));
  }
  EXPECT_GT(touching, 18);
  EXPECT_GT(sideways, 1);
  live.release(jaw);
  EXPECT_NEAR(next_frame(live).poses[mandible_body].t.norm(), 0,
              1e-9);  // back at the motion's target
}

TEST(Drag, UndoReturnsAJawThatWasPushedOutOfItsJoints) {
  const Scene scene = make_scene(builtin_patient(), without_tissue());
  constexpr BodyId jaw = mandible_body;
  LiveSimulation live(scene, resting(), without_tissue());
  await_start(live);
  const auto at = [&](const Pose& target) {
    live.drag(jaw, target);
    const FrameState frame = next_frame(live);
    EXPECT_LE(frame.contacts.max_penetration_mm(), 0.02);
    return frame.poses[mandible_body];
  };
  const Pose bite = shift(2, 0, 1.5);
  const Pose in_bite = at(bite);
  EXPECT_GT(at(shift(40, 0, 0)).t.norm(), 20);
  const Pose again = at(bite);
  EXPECT_EQ(again.t, in_bite.t);
  EXPECT_EQ(again.R.coeffs(), in_bite.R.coeffs());
  at(shift(-60, 0, 0));
  live.release(jaw);
  EXPECT_NEAR(next_frame(live).poses[mandible_body].t.norm(), 0, 1e-9);
  at(shift(40, 0, 0));
  EXPECT_NEAR(at(shift(0, 0, -3)).t.z(), -3, 1e-6);  // nothing bars it from where the motion is
}

TEST(Drag, ATargetThatJumpsTakesNoJawFromUnderItsGraftNorThroughAPart) {
  const Scene scene = make_scene(box_patient_with_free_parts(), without_tissue());
  constexpr BodyId jaw = mandible_body;
  LiveSimulation live(scene, resting(), without_tissue());
  await_start(live);
  const auto expect_apart = [&](BodyId body, const Pose& target) {
    live.drag(body, target);
    EXPECT_LE(next_frame(live).contacts.max_penetration_mm(), 0.02) << target.t.transpose();
  };
  expect_apart(jaw, shift(0, 0, -60));
  expect_apart(BodyId{3}, shift(-40, 35, -20));  // the jaw's old pose
  for (const double z : {-5.0, 60.0, -6.0, -60.0, -5.0}) expect_apart(jaw, shift(0, 0, z));
}

TEST(Drag, ATransplantSlidesAlongTheMandible) {
  const Scene scene = make_scene(box_patient_with_free_parts(), without_tissue());
  constexpr BodyId graft{2};
  LiveSimulation live(scene, resting(), without_tissue());
  await_start(live);
  FrameState frame;
  for (int k = 1; k <= 20; ++k) {
    live.drag(graft, shift(k, 0.5 * k, -0.2 * k));  // along, and down into the bone
    frame = next_frame(live);
    EXPECT_LE(frame.contacts.max_penetration_mm(), 0.02) << k;
    ASSERT_EQ(frame.poses.X_CB.size(), 4u);
    EXPECT_EQ(frame.poses[mandible_body].t, Eigen::Vector3d(0, 0, 0));
  }
  EXPECT_TRUE(frame.stopped);
  EXPECT_NEAR(frame.poses[BodyId{2}].t.x(), 20, 0.05);
  EXPECT_NEAR(frame.poses[BodyId{2}].t.y(), 10, 0.05);
  EXPECT_NEAR(frame.poses[BodyId{2}].t.z(), -0.2, 0.05);
  const double x = frame.poses[BodyId{2}].t.x();
  // Released it stays on the mandible, and moves with it.
  live.release(graft);
  live.drag(mandible_body, shift(0, 0, -10));
  while (frame.poses[mandible_body].t.z() > -9.9) frame = next_frame(live);
  EXPECT_NEAR(frame.poses[BodyId{2}].t.z(), -10.2, 0.05);
  EXPECT_NEAR(frame.poses[BodyId{2}].t.x(), x, 0.05);
  EXPECT_LE(frame.contacts.max_penetration_mm(), 0.02);
}

TEST(Drag, ASegmentIsPushedIntoAGapAndHeldAtItsWalls) {
  const Scene scene = make_scene(box_patient_with_free_parts(), without_tissue());
  constexpr BodyId segment{3};
  LiveSimulation live(scene, resting(), without_tissue());
  await_start(live);
  FrameState frame;
  // Down to the mandible's top (z = -41) and against the maxilla's side (x = 30).
  for (int k = 1; k <= 15; ++k) {
    live.drag(segment, shift(-0.7 * k, 0.3 * k, -1.2 * k));
    frame = next_frame(live);
    EXPECT_LE(frame.contacts.max_penetration_mm(), 0.02) << k;
  }
  EXPECT_TRUE(frame.stopped);
  EXPECT_NEAR(frame.poses[BodyId{3}].t.z(), -11, 0.05);
  EXPECT_NEAR(frame.poses[BodyId{3}].t.x(), -5, 0.05);
  EXPECT_NEAR(frame.poses[BodyId{3}].t.y(), 4.5, 0.05);  // it continues along the walls
  // The same pose in one jump.
  const Pose stepped = frame.poses[BodyId{3}];
  live.drag(segment, shift(0, 0, 0));
  frame = next_frame(live);
  EXPECT_EQ(frame.poses[BodyId{3}].t, Eigen::Vector3d(0, 0, 0));
  live.drag(segment, shift(-10.5, 4.5, -18));
  frame = next_frame(live);
  EXPECT_LE((frame.poses[BodyId{3}].t - stepped.t).norm(), 0.05);
}

TEST(Drag, TheJawIsHeldByASegmentThatTheCraniumCarries) {
  const Scene scene = make_scene(box_patient_with_free_parts(), without_tissue());
  LiveSimulation live(scene, resting(), without_tissue());
  await_start(live);
  live.drag(BodyId{3}, shift(0, 0, -11));  // onto the mandible's top
  FrameState frame = next_frame(live);
  EXPECT_NEAR(frame.poses[BodyId{3}].t.z(), -11, 0.02);
  live.drag(mandible_body, shift(0, 0, 0.8));
  frame = next_frame(live);
  EXPECT_TRUE(frame.stopped);
  EXPECT_LE(frame.contacts.max_penetration_mm(), 0.02);
}

TEST(Drag, WhatCannotBeMovedIsRefused) {
  const Scene scene = make_scene(box_patient_with_free_parts(), without_tissue());
  LiveSimulation live(scene, resting(), without_tissue());
  await_start(live);
  EXPECT_THROW(live.drag(cranium_body, {}), InputError);
  EXPECT_THROW(live.drag(BodyId{99}, {}), InputError);
  EXPECT_THROW(live.drag(mandible_body, shift(std::nan(""), 0, 0)), InputError);
}

}  // namespace condyle::test
