// Moving bodies by hand: numbers, handles, undo.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/window/input/gizmos.h"
#include "render/window/view/edit_history.h"
#include "render/window/view/movable.h"
#include "tests/render/window/panel_stage.h"
#include "tests/support/bodies.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

GizmoView front_view() {
  GizmoView view;
  view.camera.target = {3, -20, 5};
  view.camera.direction = {0, -1, 0};
  view.view = {100, 50, 800, 600};
  view.center = {10, -30, -15};
  return view;
}

TEST(Movable, AreTheJawTheSkullAndFreeParts) {
  std::vector<Part> parts = box_patient();
  parts.push_back(box_part("segment", Role::segment, {0, 0, 0}, {10, 20, 30}));
  const BodyTree tree = test::bodies_for(parts, {{"segment", mandible_body}});
  const auto bodies = movable_bodies(parts, tree);
  ASSERT_EQ(bodies.size(), 3u);
  EXPECT_EQ(parts[bodies[0].part].name, "mandible");
  EXPECT_TRUE(bodies[0].follows_motion);
  EXPECT_FALSE(bodies[0].is_skull());
  EXPECT_EQ(parts[bodies[1].part].name, "skull");
  EXPECT_TRUE(bodies[1].is_skull());
  EXPECT_TRUE(bodies[2].roams());
  EXPECT_EQ(bodies[2].center, Vector3d(5, 10, 15));
  const auto of = [&](std::size_t part) { return movable_body_of(bodies, parts, part); };
  EXPECT_EQ(of(3), 0u) << "lower teeth go with the jaw";
  EXPECT_EQ(of(4), 0u);
  EXPECT_EQ(of(6), 2u);
  EXPECT_EQ(of(0), 1u);
  EXPECT_EQ(of(1), 1u) << "the maxilla moves with the skull";
  EXPECT_FALSE(of(5)) << "the face deforms";
}

TEST(Movable, PlacementIsThePoseInNumbers) {
  const Vector3d center(3, -40, -60);
  const Placement requested{{1.5, -2, 7}, {20, -35, 110}};
  const Placement read = placement_of(pose_at(requested, center), center);
  EXPECT_LT((read.shift_mm - requested.shift_mm).norm(), 1e-12);
  EXPECT_LT((read.turn_deg - requested.turn_deg).norm(), 1e-10);
  // Rotation alone does not move the centre.
  EXPECT_LT((pose_at({Vector3d::Zero(), {0, 0, 30}}, center) * center - center).norm(), 1e-12);
}

bool near(const Pose& a, const Pose& b) {
  return (a.t - b.t).norm() < 1e-9 && a.R.angularDistance(b.R) < 1e-9;
}

TEST(Movable, TheSkullMovesInSpaceAgainstAFixedJaw) {
  const auto bodies = movable_bodies(box_patient(), native_bodies());
  const MovableBody &jaw = bodies[0], &skull = bodies[1];
  const Pose opened = pose_at({{0, -4, -9}, {12, 0, 3}}, jaw.center);
  const Pose up = pose_at({{2, 0, 15}, {0, 20, 0}}, skull.center);
  Hands hands;
  hands.move(jaw, opened, Pose{});
  const Hands before = hands;
  hands.move(skull, up, opened);
  ASSERT_TRUE(hands.X_CM_target());
  // Where the jaw gets there, both are at their targets, and the jaw has not moved in the room.
  EXPECT_TRUE(near(up * *hands.X_CM_target(), opened));
  EXPECT_TRUE(near(hands.X_RC(*hands.X_CM_target()), up));
  // Where contact holds them apart, it is the skull that is short of its target.
  const Pose held = pose_at({{0, -4, -12}, {12, 0, 3}}, jaw.center);
  EXPECT_TRUE(near(hands.X_RC(held) * held, opened));
  EXPECT_FALSE(near(hands.X_RC(held), up));
  // A hand that grips the jaw now does not move the skull.
  Hands further = hands;
  further.move(jaw, held, held);
  EXPECT_TRUE(near(further.X_RC(held), hands.X_RC(held)));
  EXPECT_TRUE(near(further.X_RC(Pose{}), hands.X_RC(held)));
  EXPECT_TRUE(near(*further.X_CM_target(), held));
  // So does the motion; resetting the skull clears its displacement.
  further = hands;
  further.release_jaw(held);
  EXPECT_FALSE(further.X_CM_target());
  EXPECT_TRUE(near(further.X_RC(Pose{}), hands.X_RC(held)));
  hands.put_back(skull, held);
  EXPECT_TRUE(hands == before);
}

TEST(Movable, AFreePartThatIsMovedLeavesTheJawsInTheSameHands) {
  std::vector<Part> parts = box_patient();
  parts.push_back(box_part("graft", Role::transplant, {0, 0, 0}, {10, 20, 30}));
  const BodyTree tree = test::bodies_for(parts);
  const auto bodies = movable_bodies(parts, tree);
  const Pose opened = pose_at({{0, -4, -9}, {12, 0, 3}}, bodies[0].center);
  Hands hands;
  hands.move(bodies[0], opened, Pose{});
  const Hands before = hands;
  hands.move(bodies[2], opened, opened);
  EXPECT_TRUE(hands.same_jaws(before));
  EXPECT_FALSE(hands == before);
  hands.move(bodies[1], Pose{}, opened);
  EXPECT_FALSE(hands.same_jaws(before));
}

TEST(Handles, BodyFollowsTheMouseInThePlaneOfThePicture) {
  const GizmoView view = front_view();
  const Vector2d at = screen_place(view.camera, view.view, view.center);
  for (const Vector2d& moved : {Vector2d(40, 0), Vector2d(0, 25), Vector2d(-60, -80)}) {
    const Pose pose = gripped(view, Grip::body, {}, at, at + moved);
    const Vector2d now = screen_place(view.camera, view.view, pose * view.center);
    EXPECT_LT((now - at - moved).norm(), 1e-9);
    EXPECT_NEAR(pose.t.y(), 0, 1e-12);
  }
}

TEST(Handles, ArrowKeepsToItsAxisAndItsTipToTheMouse) {
  GizmoView view = front_view();
  view.camera.direction = Vector3d(0.5, -0.8, 0.3).normalized();
  for (const auto& [grip, axis] : {std::pair{Grip::left, 0}, {Grip::back, 1}, {Grip::up, 2}}) {
    Vector2d tip;
    for (const auto& handle : gizmo_handles(view))
      if (handle.grip == grip) tip = handle.line[1];
    EXPECT_EQ(grip_at(view, tip, 8), grip);
    const Vector2d along = (tip - screen_place(view.camera, view.view, view.center)).normalized();
    const Pose pose = gripped(view, grip, {}, tip, tip + 12 * along);
    EXPECT_GT(pose.t[axis], 0);
    EXPECT_NEAR(pose.t.norm(), pose.t[axis], 1e-12);
    const Vector2d moved = screen_place(view.camera, view.view, view.center + pose.t) -
                           screen_place(view.camera, view.view, view.center);
    EXPECT_LT((moved - 12 * along).norm(), 0.5);
    // An arrow does not move across its axis.
    const Vector2d across(-along.y(), along.x());
    EXPECT_LT(gripped(view, grip, {}, tip, tip + 30 * across).t.norm(), 1e-9);
  }
}

TEST(Handles, RingTurnsWithTheMouseFromEitherSide) {
  for (const double side : {-1.0, 1.0}) {
    GizmoView view = front_view();
    view.camera.direction = {0, side, 0};
    const Vector2d c = screen_place(view.camera, view.view, view.center);
    const double r = view.ring_px * std::numbers::sqrt2 / 2;  // between the other handles
    const Vector2d from = c + Vector2d(r, r), to = c + Vector2d(r, -r);
    EXPECT_EQ(grip_at(view, from, 8), Grip::turn_back);
    const Pose pose = gripped(view, Grip::turn_back, {}, from, to);
    EXPECT_LT((pose * view.center - view.center).norm(), 1e-9);
    // The point at the first position is now at the second.
    const Vector3d right = picture_axes(view.camera).row(0);
    const Vector2d now = screen_place(view.camera, view.view, pose * (view.center + 10 * right));
    EXPECT_NEAR((now - c).x(), 0, 1e-6);
    EXPECT_LT((now - c).y(), 0);
  }
  // A ring seen edge-on rolls: its near side follows the mouse.
  const GizmoView view = front_view();
  const Vector2d c = screen_place(view.camera, view.view, view.center);
  const Pose rolled = gripped(view, Grip::turn_up, {}, c, c + Vector2d(20, 0));
  const Vector3d near = rolled * (view.center + Vector3d(0, -10, 0)) - view.center;
  EXPECT_GT(picture_axes(view.camera).row(0).dot(near), 1);
}

TEST(EditHistory, UndoAndRedoGoThroughAllEdits) {
  EditHistory<Hands> history;
  Hands now;
  std::vector<Hands> states = {now};
  for (int i = 1; i <= 3; ++i) {
    history.remember(now);
    now.set(mandible_body, Pose{Eigen::Quaterniond::Identity(), Vector3d(i, 0, 0)});
    states.push_back(now);
  }
  for (int i = 2; i >= 0; --i) {
    EXPECT_TRUE(history.undo(now));
    EXPECT_TRUE(now == states[static_cast<std::size_t>(i)]);
  }
  EXPECT_FALSE(history.undo(now));
  for (std::size_t i = 1; i <= 3; ++i) {
    EXPECT_TRUE(history.redo(now));
    EXPECT_TRUE(now == states[i]);
  }
  EXPECT_FALSE(history.redo(now));
  // An edit after an undo discards the redo history; a grip without motion is no edit.
  EXPECT_TRUE(history.undo(now));
  history.remember(now);
  EXPECT_FALSE(history.can_redo());
  EXPECT_TRUE(history.undo(now));
  EXPECT_TRUE(now == states[1]);
}

TEST(MovePanel, ButtonsUndoAndReset) {
  PanelStage stage(1280, 720, 1);
  stage.scene.bodies = movable_bodies(stage.parts, test::bodies_for(stage.parts));
  stage.rest();
  stage.click("move-tool");
  stage.rest();
  ASSERT_TRUE(stage.has("move"));
  EXPECT_TRUE(stage.has("handle:S"));
  stage.panels->remember(stage.view);
  stage.view.hands.set(mandible_body, Pose{Eigen::Quaterniond::Identity(), Vector3d(0, 0, -5)});
  stage.rest();
  stage.click("reset-position");
  EXPECT_FALSE(stage.view.hands.at(mandible_body));
  stage.rest();
  stage.click("undo");
  ASSERT_TRUE(stage.view.hands.at(mandible_body));
  stage.click("undo");
  EXPECT_FALSE(stage.view.hands.at(mandible_body));
  stage.rest();
  stage.click("redo");
  EXPECT_TRUE(stage.view.hands.at(mandible_body));
  // Playing releases the jaw from the hand.
  stage.click("play");
  EXPECT_FALSE(stage.view.hands.at(mandible_body));
}

TEST(MovePanel, DescribesGizmosAndReleaseOfEachBody) {
  PanelStage stage(1280, 720, 1);
  stage.parts.push_back(box_part("left_bone-2", Role::transplant, {85, 0, 20}, {95, 20, 40}));
  stage.scene.parts = stage.parts;
  stage.scene.bodies = movable_bodies(stage.parts, test::bodies_for(stage.parts));
  ASSERT_EQ(stage.scene.bodies.size(), 3u);
  stage.view.tool = Tool::move;
  struct Texts {
    const char *handle, *release;
  };
  const Texts texts[] = {{"Mandible: up or down, with its teeth", "Joints draw the condyles in"},
                         {"Skull: up or down, the lower jaw stays", "The lower jaw stays"},
                         {"Left bone 2: up or down, alone", "It is pushed gently"}};
  for (std::size_t body = 0; body < 3; ++body) {
    stage.view.chosen = body;
    stage.rest();
    EXPECT_FALSE(stage.has("beside-mouse"));
    const ViewRect tip = stage.item("handle:S").rect;
    stage.step(tip.x + 3, tip.y + 3, false);
    EXPECT_EQ(stage.item("beside-mouse").words, texts[body].handle);
    const ViewRect button = stage.item("release-body").rect;
    for (int i = 0; i < 60 && !stage.has("tooltip"); ++i)
      stage.step(button.x + 20, button.y + 10, false);
    EXPECT_TRUE(stage.item("tooltip").words.starts_with(texts[body].release));
    EXPECT_TRUE(stage.item("tooltip").words.ends_with("another motion end this"));
  }
}

TEST(MovePanel, PlayStepsAndTheSliderLeaveASkullThatContactHolds) {
  const auto start = [](PanelStage& stage) {
    stage.scene.bodies = movable_bodies(stage.parts, test::bodies_for(stage.parts));
    stage.view.tool = Tool::move;
    stage.frame.poses[mandible_body] = Pose{Eigen::Quaterniond::Identity(), {0, -4, -20}};
    const Pose down{Eigen::Quaterniond::Identity(), {0, 0, -60}};
    stage.view.move(stage.scene.bodies[1], down, stage.frame.poses[mandible_body]);
    stage.frame.poses[mandible_body] = Pose{Eigen::Quaterniond::Identity(), {0, -4, 20}};
    stage.rest();
    return stage.view.hands.X_RC(stage.frame.poses[mandible_body]);
  };
  using Action = void (*)(PanelStage&);
  const Action actions[] = {
      [](PanelStage& stage) { stage.click("play"); },
      [](PanelStage& stage) { stage.panels->run(Command::step_forward, stage.scene, stage.view); },
      [](PanelStage& stage) { stage.click("scrub"); },
      [](PanelStage& stage) { stage.click("opening"); }};
  for (const Action take_jaw : actions) {
    PanelStage stage(1280, 720, 1);
    const Pose held = start(stage);
    EXPECT_NEAR(held.t.z(), -40, 1e-9);
    take_jaw(stage);
    EXPECT_FALSE(stage.view.hands.X_CM_target());
    EXPECT_TRUE(near(stage.view.hands.X_RC(stage.frame.poses[mandible_body]), held));
    EXPECT_TRUE(near(stage.view.hands.X_RC(Pose{}), held));
  }
}

TEST(MovePanel, TheSkullIsResetToAMouthThatTheSliderHeldOpen) {
  PanelStage stage(1280, 720, 1);
  stage.scene.bodies = movable_bodies(stage.parts, test::bodies_for(stage.parts));
  stage.view.tool = Tool::move;
  stage.view.chosen = 1;
  stage.view.opening_mm = 20;
  stage.frame = box_frame(1, 20);
  const Pose opened = stage.frame.poses[mandible_body];
  stage.rest();
  stage.enter("shift:S", "1");
  EXPECT_FALSE(stage.view.opening_mm);
  stage.frame.poses[mandible_body] = *stage.view.hands.X_CM_target();
  EXPECT_FALSE(near(stage.frame.poses[mandible_body], opened));
  stage.rest();
  stage.click("reset-position");
  ASSERT_TRUE(stage.view.hands.X_CM_target());
  EXPECT_TRUE(near(*stage.view.hands.X_CM_target(), opened));
  EXPECT_TRUE(near(stage.view.hands.X_RC(opened), Pose{}));
}

TEST(MovePanel, OffersReleaseOfEveryBodyWithItsEffect) {
  PanelStage stage(1280, 720, 1);
  stage.parts.push_back(box_part("graft", Role::transplant, {0, 0, 0}, {10, 20, 30}));
  stage.scene.parts = stage.parts;
  stage.scene.bodies = movable_bodies(stage.parts, test::bodies_for(stage.parts));
  stage.view.fit(stage.scene);
  stage.view.tool = Tool::move;
  for (std::size_t body = 0; body < 3; ++body) {
    stage.view.chosen = body;
    stage.rest();
    stage.click("release-body");
    const auto requests = stage.panels->take_requests();
    ASSERT_EQ(requests.size(), 1u);
    EXPECT_EQ(std::get<request::Release>(requests[0]).body, body);
  }
}

TEST(MovePanel, NumbersMoveAndResetTheSkull) {
  PanelStage stage(1280, 720, 1);
  stage.scene.bodies = movable_bodies(stage.parts, test::bodies_for(stage.parts));
  stage.view.tool = Tool::move;
  stage.rest();
  stage.click("body");
  stage.rest();
  stage.click("body:skull");
  stage.rest();
  EXPECT_EQ(stage.item("move-state").words, "in its place");
  stage.enter("shift:S", "7");
  ASSERT_TRUE(stage.view.hands.at(cranium_body));
  EXPECT_NEAR((*stage.view.hands.at(cranium_body) * stage.scene.bodies[1].center -
               stage.scene.bodies[1].center)
                  .z(),
              7, 1e-9);
  ASSERT_TRUE(stage.view.hands.X_CM_target());
  EXPECT_EQ(stage.item("move-state").words, "held by contact, 7.0 mm short");
  stage.frame.poses[mandible_body] = *stage.view.hands.X_CM_target();
  stage.rest();
  EXPECT_EQ(stage.item("move-state").words, "at its target");
  EXPECT_EQ(stage.item("reached:shift:S").words, "7.00 mm");
  stage.click("reset-position");
  EXPECT_FALSE(stage.view.hands.at(cranium_body));
  EXPECT_FALSE(stage.view.jaw_is_held());
  stage.panels->run(Command::undo, stage.scene, stage.view);
  EXPECT_TRUE(stage.view.hands.at(cranium_body));
}

/// A jaw whose target is 12 mm up and turned, and is held by contact at rest.
class HeldJaw : public testing::Test {
 protected:
  HeldJaw() {
    stage.scene.bodies = movable_bodies(stage.parts, test::bodies_for(stage.parts));
    stage.frame = box_frame(0, 0);
    stage.view.hands.set(mandible_body,
                         pose_at({{0, 1.2345678, 12}, {3, 0, 0}}, stage.scene.bodies[0].center));
    stage.view.tool = Tool::move;
    stage.rest();
  }
  PanelStage stage{1280, 720, 1};
};

TEST_F(HeldJaw, ShowsTheTargetBesideThePoseReached) {
  EXPECT_EQ(stage.item("shift:S").words, "12.00 mm");
  EXPECT_EQ(stage.item("reached:shift:S").words, "0.00 mm");
  EXPECT_EQ(stage.item("turn:L").words, "3.00\u00b0");
  EXPECT_EQ(stage.item("reached:turn:L").words, "0.00\u00b0");
  EXPECT_EQ(stage.item("move-state").words, "held by contact, 12.1 mm and 3.0\u00b0 short");
  stage.frame.poses[mandible_body] =
      pose_at({{0, 1.2345678, 7.5}, {3, 0, 0}}, stage.scene.bodies[0].center);
  stage.rest();
  EXPECT_EQ(stage.item("reached:shift:S").words, "7.50 mm");
  EXPECT_EQ(stage.item("move-state").words, "held by contact, 4.5 mm short");
  stage.frame.poses[mandible_body] = *stage.view.hands.at(mandible_body);
  stage.rest();
  EXPECT_EQ(stage.item("reached:shift:S").words, "12.00 mm");
  EXPECT_EQ(stage.item("move-state").words, "at its target");
  // Without a hand both are where the jaw is.
  stage.view.hands.set(mandible_body, std::nullopt);
  stage.frame = box_frame(1, 20);
  stage.rest();
  EXPECT_EQ(stage.item("shift:S").words, stage.item("reached:shift:S").words);
  EXPECT_NE(stage.item("shift:S").words, "0.00 mm");
}

TEST_F(HeldJaw, OnlyAnotherNumberIsAnEdit) {
  const Pose before = *stage.view.hands.at(mandible_body);
  const auto as_before = [&] {
    return stage.view.hands.at(mandible_body)->t == before.t &&
           stage.view.hands.at(mandible_body)->R.coeffs() == before.R.coeffs();
  };
  for (const char* words : {"abc", "", "1.23", "1e999", "--"}) {
    stage.enter("shift:P", words);
    EXPECT_TRUE(as_before()) << words;
    stage.panels->run(Command::undo, stage.scene, stage.view);
    EXPECT_TRUE(as_before()) << "'" << words << "' was a step of undo";
  }
  stage.enter("shift:S", "4.5");
  const Placement now =
      placement_of(*stage.view.hands.at(mandible_body), stage.scene.bodies[0].center);
  EXPECT_NEAR(now.shift_mm.z(), 4.5, 1e-9);
  EXPECT_NEAR(now.shift_mm.y(), 1.2345678, 1e-9) << "the others are not rounded";
  stage.panels->run(Command::undo, stage.scene, stage.view);
  EXPECT_TRUE(as_before());
}

TEST_F(HeldJaw, ANumberIsEnteredByAClickElsewhereToo) {
  stage.click("shift:S");
  stage.rest();
  ImGui::GetIO().AddInputCharactersUTF8("4.5");
  stage.rest();
  const auto up_mm = [&] {
    return placement_of(*stage.view.hands.at(mandible_body), stage.scene.bodies[0].center)
        .shift_mm.z();
  };
  EXPECT_NEAR(up_mm(), 12, 1e-9) << "not while it is written";
  stage.click("turn:S");
  stage.rest();
  EXPECT_NEAR(up_mm(), 4.5, 1e-9);
  EXPECT_EQ(stage.item("turn:S").words, "0.00\u00b0") << "the next field has nothing of it";
}

TEST_F(HeldJaw, AFieldAboveIsClickedWhileOneIsWrittenIn) {
  stage.click("turn:S");
  stage.rest();
  ImGui::GetIO().AddInputCharactersUTF8("4.5");
  stage.rest();
  stage.click("shift:S");
  stage.rest();
  const Placement now =
      placement_of(*stage.view.hands.at(mandible_body), stage.scene.bodies[0].center);
  EXPECT_NEAR(now.turn_deg.z(), 4.5, 1e-9);
  EXPECT_NEAR(now.shift_mm.z(), 12, 1e-9);
}

TEST_F(HeldJaw, TextOfARemovedFieldIsDiscarded) {
  const Hands before = stage.view.hands;
  for (const char* next : {"turn:L", "shift:S"}) {
    stage.click("shift:S");
    stage.rest();
    ImGui::GetIO().AddInputCharactersUTF8("4.5");
    stage.rest();
    stage.view.tool = Tool::look;
    stage.rest();
    stage.view.tool = Tool::move;
    stage.rest();
    stage.click(next);
    stage.rest();
    stage.click("shift:L");
    stage.rest();
    EXPECT_TRUE(stage.view.hands == before) << next;
  }
}

}  // namespace
}  // namespace condyle
