// Movements end at their targets, on the teeth where there are teeth.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "engine/core/error.h"
#include "sim/motion/measure_pose.h"
#include "sim/motion/motion.h"
#include "sim/muscles/default_face_muscles.h"
#include "tests/sim/motion/jaws.h"
#include "tests/support/builtin.h"
#include "tests/support/real_cases.h"

namespace condyle::test {
namespace {

using Eigen::Vector3d;

struct Moved {
  Case patient;
  ContactModel contacts;
  Motion motion;
  Vector3d start;

  Moved(const Case& jaw, const std::string& spec, const MotionSettings& settings = {})
      : patient(jaw),
        contacts(patient),
        motion(make_motion(spec, patient, contacts, settings)),
        start(*patient.landmarks.find("lower_incisal_point")) {}
  Vector3d incisor(double time_s) const { return motion.target(time_s) * start - start; }
  double end_of(const std::string& phase) const {
    for (const auto& p : motion.phases)
      if (p.name == phase) return p.end_s;
    ADD_FAILURE() << phase;
    return 0;
  }
  /// Deepest overlap of the teeth beyond rest, and the widest gap between them, from t0 to t1.
  std::pair<double, double> teeth(double t0, double t1) const {
    double deepest = 0, widest = 0;
    ContactSet last = contacts.at_rest();
    for (int i = 0; i <= 80; ++i) {
      last = contacts.find(motion.target(t0 + (t1 - t0) * i / 80), &last);
      deepest = std::max(deepest, last.max_penetration_mm());
      for (const auto& pair : last.pairs)
        if (pair.policy == PairPolicy::allowed) widest = std::max(widest, pair.distance_mm);
    }
    return {deepest, widest};
  }
};

void expect_refused(const Case& jaw, const std::string& spec, const std::string& word) {
  try {
    Moved moved(jaw, spec);
    ADD_FAILURE() << spec;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

}  // namespace

TEST(Movements, ReachTheirTargets) {
  const Moved moved(jaw_with_teeth(),
                    "open 30; close; protrude 6; close; left 7; close; right 5; close; rest 3");
  EXPECT_NEAR(-moved.incisor(moved.end_of("opening")).z(), 30, 1e-3);
  EXPECT_LT(moved.incisor(moved.end_of("closing")).norm(), 1e-9);
  EXPECT_NEAR(-moved.incisor(moved.end_of("protrusion")).y(), 6, 0.02);
  EXPECT_NEAR(moved.incisor(moved.end_of("laterotrusion left")).x(), 7, 0.02);
  EXPECT_NEAR(moved.incisor(moved.end_of("laterotrusion right")).x(), -5, 0.02);
  EXPECT_NEAR(-moved.incisor(moved.motion.duration_s).z(), 3, 1e-3);
}

Case expressive_jaw() {
  Case patient = free_jaw();
  for (const auto& [name, at] : builtin().landmarks.points) patient.landmarks.points[name] = at;
  return patient;
}

/// Excitation of the left zygomaticus major.
double left_zygomatic(const Moved& moved, double time_s) {
  const std::vector<FaceMuscle> muscles = default_face_muscles(moved.patient);
  const std::vector<double> excitation = moved.motion.expression(time_s).muscles;
  for (std::size_t m = 0; m < muscles.size(); ++m)
    if (muscles[m].name == "left_zygomaticus_major") return excitation.at(m);
  ADD_FAILURE();
  return 0;
}

TEST(Movements, ExpressionsExciteTheMusclesThatTheCaseBrings) {
  Case patient = expressive_jaw();
  FaceMuscle own{.name = "left_risorius", .kind = "risorius", .limit_N = 1, .lines = {}};
  own.lines = {{{.at = {60, -60, -50}}, {.at = {26, -88, -50}}}};
  patient.face_muscles = {own};
  const Moved moved(patient, "AU20 0.7; rest");
  const std::vector<FaceMuscle> muscles = muscles_of_face(moved.patient);
  ASSERT_EQ(muscles.front().name, "left_risorius");
  const std::vector<double> excitation = moved.motion.expression(0.5).muscles;
  ASSERT_EQ(excitation.size(), muscles.size());
  for (std::size_t m = 0; m < muscles.size(); ++m)
    EXPECT_NEAR(excitation[m], muscles[m].kind == "risorius" ? 0.7 : 0, 1e-9) << muscles[m].name;
}

TEST(Movements, TheUpperFaceMovesByItsExpressionsAlone) {
  EXPECT_TRUE(motion_moves_upper_face("open 10; surprise"));
  EXPECT_TRUE(motion_moves_upper_face("inverse:AU4 0.5 left over 1"));
  for (const char* others : {"smile; rest", "inverse:open 5; close", "inverse:opening", "opening",
                             "muscles:nowhere.csv", "nowhere.csv"})
    EXPECT_FALSE(motion_moves_upper_face(others)) << others;
}

TEST(Movements, AnExpressionLastsUntilRestAndTakesItsTime) {
  const Moved moved(expressive_jaw(), "smile 0.8 over 0.4; open 10 over 1; rest");
  EXPECT_LT(moved.incisor(0.4).norm(), 1e-9);
  EXPECT_EQ(left_zygomatic(moved, 0), 0);
  EXPECT_NEAR(left_zygomatic(moved, 0.2), 0.4, 1e-9);
  EXPECT_NEAR(left_zygomatic(moved, 1.4), 0.8, 1e-9);
  EXPECT_NEAR(-moved.incisor(1.4).z(), 10, 1e-3);
  EXPECT_NEAR(left_zygomatic(moved, 1.9), 0.4, 1e-9) << "the face relaxes within 1 s";
  EXPECT_EQ(left_zygomatic(moved, moved.motion.duration_s), 0);
  EXPECT_GE(moved.motion.duration_s, 2.4 - 1e-9);
}

TEST(Movements, AnExpressionAndTheJawMoveTogetherWhereJoined) {
  const Moved moved(expressive_jaw(), "smile left over 2 and open 10 over 1; sad; neutral over 3");
  EXPECT_NEAR(-moved.incisor(1).z(), 10, 1e-3);
  EXPECT_NEAR(left_zygomatic(moved, 1), 0.5, 1e-9);
  EXPECT_NEAR(-moved.incisor(2).z(), 10, 1e-3);
  EXPECT_NEAR(left_zygomatic(moved, 2), 1, 1e-9);
  EXPECT_NEAR(left_zygomatic(moved, 2.5), 0, 1e-9) << "an expression replaces the last";
  EXPECT_NEAR(moved.motion.duration_s, 5.5, 1e-9);
  const Moved units(expressive_jaw(), "AU12 0.6 left; AU10; smile right; hold 1; AU12 0.2 left");
  EXPECT_NEAR(left_zygomatic(units, 2.5), 0.6, 1e-9) << "action units and other sides stay";
  EXPECT_NEAR(left_zygomatic(units, 3), 0.2, 1e-9);
  EXPECT_LT(units.incisor(3).norm(), 1e-9);
}

TEST(Movements, ABlinkClosesTheLidsForAMomentAndKeepsTheExpression) {
  const Moved moved(expressive_jaw(), "smile; blink 0.8 left and open 10 over 1; AU43; hold 1");
  const auto lids = [&](double time_s) { return moved.motion.expression(time_s).lids; };
  EXPECT_FALSE(lids(0.5).any());
  EXPECT_NEAR(lids(0.55).left, 0.4, 1e-9) << "closing takes 0.1 s";
  EXPECT_NEAR(lids(0.62).left, 0.8, 1e-9);
  EXPECT_NEAR(lids(0.64 + 0.085).left, 0.4, 1e-9) << "opening takes 0.17 s";
  EXPECT_FALSE(lids(0.82).any());
  for (const double time_s : {0.55, 0.62, 0.7}) EXPECT_EQ(lids(time_s).right, 0);
  for (const double time_s : {0.5, 0.6, 0.7, 0.9})
    EXPECT_NEAR(left_zygomatic(moved, time_s), 1, 1e-9) << "the smile stays";
  EXPECT_NEAR(-moved.incisor(1.5).z(), 10, 1e-3) << "while the jaw opens";
  EXPECT_NEAR(lids(2.5).left, 1, 1e-9);
  EXPECT_NEAR(lids(2.5).right, 1, 1e-9) << "AU43 holds them closed";
}

TEST(Movements, ABlinkDoesNotOpenLidsThatAreHeldFurtherClosed) {
  const Moved moved(expressive_jaw(), "AU45 0.8 left; blink 0.5; hold 1");
  const auto lids = [&](double time_s) { return moved.motion.expression(time_s).lids; };
  for (const double time_s : {0.5, 0.55, 0.62, 0.7, 0.81, 1.5})
    EXPECT_NEAR(lids(time_s).left, 0.8, 1e-9) << time_s;
  EXPECT_NEAR(lids(0.62).right, 0.5, 1e-9);
  EXPECT_NEAR(lids(0.82).right, 0, 1e-9);
}

TEST(Movements, LidsMoveByTheirActionUnitsBlinksAndSurpriseAlone) {
  for (const char* moving : {"open 10; blink left", "inverse:AU43 0.5 over 1", "smile and AU45",
                             "AU5 0.5", "surprise; rest"})
    EXPECT_TRUE(motion_moves_lids(moving)) << moving;
  for (const char* others :
       {"smile; rest", "AU43 0; hold 1", "AU5 0; hold 1", "opening", "nowhere.csv"})
    EXPECT_FALSE(motion_moves_lids(others)) << others;
}

TEST(Movements, ALongerMotionHasASlowerExpression) {
  MotionSettings slow;
  slow.duration_s = 5;
  EXPECT_NEAR(left_zygomatic(Moved(expressive_jaw(), "smile", slow), 2.5), 0.5, 1e-9);
}

TEST(Movements, AnExpressionNeedsTheLandmarksOfItsMuscles) {
  expect_refused(free_jaw(), "smile; open 10", "left_cheilion");
  expect_refused(free_jaw(), "smile", "left_cheilion");
}

TEST(Movements, ContactMovementsGlideOnTheTeethAndOpenOverTheIncisors) {
  const Moved moved(jaw_with_teeth(), "protrude 3; close; left 6; close");
  const auto [deepest, widest] = moved.teeth(0, moved.motion.duration_s);
  EXPECT_LT(deepest, 0.1);
  EXPECT_LT(widest, 0.25);
  // Past the upper incisors, whose edge is 2 mm below the lower one's.
  EXPECT_LT(moved.incisor(moved.end_of("protrusion")).z(), -1.9);
}

TEST(Movements, AnIncisalTableGuidesWhereItIsSteeperThanTheTeeth) {
  const Moved moved(jaw_with_teeth(), "protrude 5", {.parameters = {.incisal_guidance_deg = 40}});
  const Vector3d end = moved.incisor(moved.motion.duration_s);
  EXPECT_NEAR(-end.z(), 5 * std::tan(40 * std::numbers::pi / 180), 0.05);
}

TEST(Movements, FollowEachOtherWithoutJumps) {
  const Moved moved(
      jaw_with_teeth(),
      "open 25; left 6; protrude 3; close; chew right 2; rest; hinge 6; open 12 at 80; retrude; "
      "posselt; hold 0.1; chew left 1; right 3");
  const int steps = static_cast<int>(moved.motion.duration_s * 500);
  Pose before = moved.motion.target(0);
  EXPECT_LT(before.t.norm(), 1e-9);
  for (int i = 1; i <= steps; ++i) {
    const Pose now = moved.motion.target(moved.motion.duration_s * i / steps);
    EXPECT_LT((now * moved.start - before * moved.start).norm(), 0.6) << i;
    before = now;
  }
  double last = 0;
  for (const auto& phase : moved.motion.phases) {
    EXPECT_NEAR(phase.start_s, last, 1e-9);
    EXPECT_GT(phase.end_s, phase.start_s);
    last = phase.end_s;
  }
  EXPECT_NEAR(last, moved.motion.duration_s, 1e-9);
}

TEST(Movements, TakeTheSpecifiedTime) {
  const Moved moved(jaw_with_teeth(), "open 20 over 2; close at 50; hold 0.7");
  EXPECT_NEAR(moved.end_of("opening"), 2, 1e-9);
  EXPECT_NEAR(moved.end_of("hold") - moved.end_of("closing"), 0.7, 1e-9);
  const double distance = moved.incisor(2).norm();
  EXPECT_NEAR(moved.end_of("closing") - 2, distance / 50, 0.05 * distance / 50);
  const Moved whole(jaw_with_teeth(), "open 20 over 2; close", {.duration_s = 6});
  EXPECT_NEAR(whole.motion.duration_s, 6, 1e-9);
  EXPECT_NEAR(whole.motion.phases.back().end_s, 6, 1e-9);
}

TEST(Movements, RefuseUnreachableTargetsAndStateTheLimit) {
  expect_refused(jaw_with_teeth(), "left 19", "reaches");
  expect_refused(jaw_with_teeth(), "open 70", "opens to");
  expect_refused(jaw_with_teeth(), "close\nopen 75", "line 2");
  expect_refused(jaw_with_teeth(), "set opening 20; chew left 2 size 30",
                 "exceeds the maximum opening");
}

TEST(Movements, OpenToTheirTargetAsIfItWereAParameter) {
  // Unasked this jaw opens by some 45 mm.
  const Moved unasked(free_jaw(), "open over 1; close"), asked(free_jaw(), "open 50 over 1; close"),
      set(free_jaw(), "set opening 50; open 50 over 1; close");
  EXPECT_LT(-unasked.incisor(1).z(), 49);
  EXPECT_NEAR(-asked.incisor(1).z(), 50, 1e-3);
  EXPECT_EQ(asked.incisor(1), set.incisor(1));
  const auto& notes = asked.motion.notes;
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
    return note.find("by default this jaw opens to 4") != std::string::npos;
  }));
  // A plain opening is not affected by another one with a larger target.
  const Moved both(free_jaw(), "open over 1; close over 1; open 50 over 1; close");
  EXPECT_NEAR(both.incisor(1).z(), unasked.incisor(1).z(), 0.01);
  EXPECT_NEAR(-both.incisor(3).z(), 50, 1e-3);
  // The patient's own opening is unchanged; an explicit one is respected.
  const auto own = [](const Moved& moved) {
    for (const MotionInput& found : moved.motion.found)
      if (found.name == "opening") return found.value;
    return 0.0;
  };
  EXPECT_GT(own(unasked), 40);
  EXPECT_EQ(own(asked), own(unasked));
  expect_refused(free_jaw(), "set opening 30; open 50", "opens to 30.0 mm");
}

TEST(Chewing, CyclesAreRoundsOfTheRightSizeAndSideWithAPause) {
  for (const bool left : {true, false}) {
    const Moved moved(jaw_with_teeth(), left ? "chew left 3 rate 1.25 size 14 width 5"
                                             : "chew right 3 rate 1.25 size 14 width 5");
    EXPECT_NEAR(moved.motion.duration_s, 3 / 1.25, 1e-9);
    double lowest = 0, farthest = 0, other = 0, still = 0, area = 0;
    const int steps = 2000;
    Vector3d before = Vector3d::Zero();
    for (int i = 1; i <= steps; ++i) {
      const Vector3d now = moved.incisor(0.8 * i / steps);
      const double aside = left ? now.x() : -now.x();
      lowest = std::min(lowest, now.z());
      farthest = std::max(farthest, aside);
      other = std::min(other, aside);
      still += now.norm() < 1e-3 ? 0.8 / steps : 0;
      area += 0.5 * (before.x() * now.z() - now.x() * before.z());
      before = now;
    }
    EXPECT_NEAR(-lowest, 14, 0.1);
    EXPECT_NEAR(farthest, 4.5, 0.3);
    EXPECT_GT(other, -1);
    EXPECT_NEAR(still, 0.128, 0.04);
    // It closes from the side that chews.
    EXPECT_GT(left ? area : -area, 15);
    EXPECT_LT((moved.incisor(0.8) - moved.incisor(1.6)).norm(), 1e-6);
  }
}

TEST(Posselt, BordersEncloseAllOtherMovements) {
  const Moved moved(jaw_with_teeth(), "posselt");
  const auto& round = moved.motion.borders;
  ASSERT_GT(round.sagittal.size(), 50u);
  ASSERT_GT(round.frontal.size(), 50u);
  double left = 0, right = 0, low = 0, front = 0;
  for (const auto& p : round.frontal) {
    left = std::max(left, p.x() - moved.start.x());
    right = std::max(right, moved.start.x() - p.x());
  }
  for (const auto& p : round.sagittal) {
    low = std::max(low, moved.start.z() - p.z());
    front = std::max(front, moved.start.y() - p.y());
  }
  EXPECT_GT(left, 8.9);
  EXPECT_NEAR(left, right, 0.05);  // the jaw is symmetric
  EXPECT_NEAR(front, 8, 0.1);
  EXPECT_GT(low, 40);
  // An ordinary opening stays in front of the posterior border.
  const Moved opening(jaw_with_teeth(), "open 30", {.parameters = {.early_translation = 0.5}});
  for (int i = 1; i < 20; ++i) {
    const Vector3d p = opening.incisor(opening.motion.duration_s * i / 20) + opening.start;
    double border = 1e9, nearest = 1e9;
    for (std::size_t k = 0; k < round.sagittal.size() / 2; ++k)
      if (std::abs(round.sagittal[k].z() - p.z()) < nearest) {
        nearest = std::abs(round.sagittal[k].z() - p.z());
        border = round.sagittal[k].y();
      }
    EXPECT_LT(p.y(), border + 0.5) << i;
  }
}

TEST(RealMovements, UbcGlidesOnItsTeethNoDeeperThanAtRest) {
  const auto patient = case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const Moved moved(*patient, "protrude 5; close; left 5; close");
  EXPECT_NEAR(-moved.incisor(moved.end_of("protrusion")).y(), 5, 0.02);
  EXPECT_NEAR(moved.incisor(moved.end_of("laterotrusion left")).x(), 5, 0.02);
  const auto [deepest, widest] = moved.teeth(0, moved.motion.duration_s);
  EXPECT_LT(deepest, 0.3);  // fused crowns of the maxilla are a hair larger than the teeth
  EXPECT_LT(widest, 0.5);
}

TEST(RealMovements, BadinClosesUntilItMeets) {
  const auto patient = case_badin();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const Moved moved(*patient, "close; protrude 6; close");
  const ContactSet shut =
      moved.contacts.find(moved.motion.target(moved.end_of("closing")), nullptr);
  EXPECT_LT(shut.min_clearance_mm(), 0.05);
  EXPECT_LT(shut.max_penetration_mm(), 0.05);
  EXPECT_GT(moved.incisor(moved.end_of("closing")).z(), 3);  // its rest pose is open
}

TEST(RealMovements, BadinsLateralMotionEndsWhereItBegan) {
  const auto patient = case_badin();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const Moved moved(*patient, "laterotrusion-left");
  EXPECT_GT(moved.incisor(moved.end_of("closing")).norm(), 3);  // in its bite, above its rest
  EXPECT_LT(moved.incisor(moved.motion.duration_s).norm(), 1e-9);
}

}  // namespace condyle::test
