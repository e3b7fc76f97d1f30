#include <gtest/gtest.h>

#include <memory>

#include "engine/core/error.h"
#include "sim/case/edit_bodies.h"
#include "sim/phantom/phantom.h"
#include "sim/simulator/simulator.h"
#include "tests/support/boxes.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

Pose displaced(double x, double y, double z) { return {Eigen::Quaterniond::Identity(), {x, y, z}}; }

SimulatorSettings bones_alone() {
  SimulatorSettings settings;
  settings.tissue = false;
  return settings;
}

/// A block in front of the chin, at this distance.
Part block(const Case& patient, const char* name, Role role, double ahead_mm) {
  const Vector3d front = *patient.landmarks.find("pogonion") - Vector3d(0, ahead_mm, 0);
  return {name, role, box(front - Vector3d(6, 6, 4), front + Vector3d(6, 0, 4)), {}};
}

/// The built-in patient, then with a segment on the mandible, then with a graft on the segment.
std::vector<Case> operated() {
  std::vector<Case> history = {builtin_patient()};
  history.push_back(with_piece(history[0], block(history[0], "chin", Role::segment, 2),
                               mandible_body, BodyDriver::plan));
  history.push_back(with_piece(history[1], block(history[1], "graft", Role::transplant, 10),
                               *history[1].bodies.find("chin")));
  return history;
}

/// The jaw opens while the last body is pushed backward, into obstacles.
std::vector<FrameState> run(const Scene& scene) {
  std::vector<FrameState> frames = {rest_frame(scene)};
  TissueWarmStart warm;
  for (int k = 1; k <= 6; ++k) {
    StepInput input{.time_s = 0.1 * k};
    input.X_PB_target.resize(scene.patient.bodies.bodies().size());
    input.X_PB_target[1] = displaced(0, -k, -2 * k);
    if (input.X_PB_target.size() > 2) input.X_PB_target.back() = displaced(0.2 * k, k, 0);
    frames.push_back(step(scene, frames.back(), input, bones_alone(), warm));
  }
  return frames;
}

void expect_same(const Scene& edited, const Case& patient, const char* what) {
  const Scene made = make_scene(patient, bones_alone());
  EXPECT_EQ(edited.contacts.notes(), made.contacts.notes()) << what;
  const auto x = run(edited), y = run(made);
  for (std::size_t k = 0; k < x.size(); ++k) EXPECT_EQ(x[k].state_hash, y[k].state_hash) << what;
}

}  // namespace

TEST(Bodies, AGraftOnASegmentOnTheMandibleIsCarriedAndSlidesOntoBone) {
  const Case patient = operated().back();
  const BodyId chin{2}, graft{3};
  const Scene scene = make_scene(patient, bones_alone());
  StepInput input{.time_s = 0.1, .X_PB_target = {Pose{}, displaced(0, -5, -12)}};
  TissueWarmStart warm;
  FrameState frame = step(scene, rest_frame(scene), input, bones_alone(), warm);
  EXPECT_EQ(frame.poses[graft].t, Vector3d(0, -5, -12));  // along with the jaw
  EXPECT_FALSE(frame.stopped);
  input.X_PB_target.push_back(displaced(0, -3, 0));
  frame = step(scene, frame, input, bones_alone(), warm);
  EXPECT_EQ(frame.poses[graft].t, Vector3d(0, -8, -12));  // along with the segment
  EXPECT_EQ(pose_in(chin, graft, frame.poses).t, Vector3d(0, 0, 0));
  EXPECT_EQ(pose_in(mandible_body, chin, frame.poses).t, Vector3d(0, -3, 0));
  input.X_PB_target.push_back(displaced(0, 8, 0));
  frame = step(scene, frame, input, bones_alone(), warm);
  EXPECT_TRUE(frame.stopped);
  EXPECT_NEAR(pose_in(chin, graft, frame.poses).t.y(), 2, 0.05);  // the segment is 2 mm behind it
  EXPECT_LE(frame.contacts.max_penetration_mm(), 0.02);
  EXPECT_EQ(scene.contacts.rules().size(), frame.contacts.pairs.size());
}

TEST(Bodies, EditedScenesEqualThoseBuiltAnew) {
  std::vector<Case> history = operated();
  const SimulatorSettings settings = bones_alone();
  auto scene = std::make_unique<Scene>(make_scene(history[0], settings));
  scene->contacts.prepare_sliding();
  for (std::size_t i = 1; i < history.size(); ++i) {
    scene = std::make_unique<Scene>(edited_scene(*scene, history[i], settings));
    scene->contacts.prepare_sliding();
    expect_same(*scene, history[i], "added");
  }
  history.push_back(with_parent(history.back(), BodyId{3}, mandible_body));
  EXPECT_EQ(history.back().bodies[*history.back().bodies.find("graft")].parent, mandible_body);
  scene = std::make_unique<Scene>(edited_scene(*scene, history.back(), settings));
  expect_same(*scene, history.back(), "hung on another");
  history.push_back(without_body(history.back(), BodyId{2}));
  EXPECT_EQ(history.back().parts.back().name, "graft");
  EXPECT_EQ(history.back().parts.back().body, BodyId{2});
  scene = std::make_unique<Scene>(edited_scene(*scene, history.back(), settings));
  expect_same(*scene, history.back(), "removed");
  scene = std::make_unique<Scene>(edited_scene(*scene, history[1], settings));
  expect_same(*scene, history[1], "undone");
}

TEST(Bodies, TissueUnaffectedByAnEditIsKept) {
  const std::vector<Case> history = operated();
  const SimulatorSettings settings;
  const Scene before = make_scene(history[0], settings);
  const Scene after = edited_scene(
      before, with_piece(before.patient, history[1].parts.back(), mandible_body), settings);
  EXPECT_EQ(before.tissue, after.tissue);
  Case wider = before.patient;
  for (auto& v :
       wider.parts[static_cast<std::size_t>(wider.find(Role::mandible) - wider.parts.data())]
           .mesh.vertices)
    v.x() *= 1.001;
  EXPECT_NE(before.tissue, edited_scene(before, wider, settings).tissue);
}

TEST(Bodies, EditsThatCannotBeAreRefused) {
  const Case patient = operated().back();
  EXPECT_THROW(without_body(patient, cranium_body), InputError);
  EXPECT_THROW(without_body(patient, mandible_body), InputError);
  EXPECT_THROW(with_parent(patient, BodyId{2}, BodyId{3}), InputError);
  EXPECT_THROW(with_piece(patient, patient.parts.back(), cranium_body), InputError);
  EXPECT_THROW(with_parent(patient, BodyId{9}, cranium_body), InputError);
}

}  // namespace condyle::test
