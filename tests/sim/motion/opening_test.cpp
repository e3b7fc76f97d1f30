#include <gtest/gtest.h>

#include <stdexcept>

#include "engine/core/error.h"
#include "sim/motion/condylar_kinematics.h"
#include "sim/motion/jaw_joints.h"
#include "sim/motion/joint_surfaces.h"
#include "sim/motion/measure_pose.h"
#include "sim/motion/motion.h"
#include "tests/sim/motion/jaws.h"
#include "tests/support/real_cases.h"

namespace condyle::test {
namespace {

MotionSettings opening_by(double mm) { return {.parameters = {.opening_mm = mm}}; }
MotionSettings early(double fraction) { return {.parameters = {.early_translation = fraction}}; }

Motion opening_of(const Case& patient, const MotionSettings& settings = {}) {
  return make_motion("opening", patient, ContactModel(patient), settings);
}

double largest(double Measures::*value, const Motion& motion, const Case& patient) {
  constexpr int frames = 360;
  double most = 0;
  for (int i = 0; i <= frames; ++i)
    most = std::max(most, measure(patient, motion.target(motion.duration_s * i / frames)).*value);
  return most;
}
double largest_opening(const Motion& motion, const Case& patient) {
  return largest(&Measures::opening_mm, motion, patient);
}

TEST(Opening, OpensToItsTargetAndClosesAgain) {
  const Case patient = free_jaw();
  // By default the mean of adults: Woelfel's displacement of the incisal point.
  EXPECT_NEAR(largest(&Measures::incisal_displacement_mm, opening_of(patient), patient), 51.2,
              1e-3);
  for (const double asked : {5.0, 20.0, 42.0})
    EXPECT_NEAR(largest_opening(opening_of(patient, opening_by(asked)), patient), asked, 1e-3);
  const Motion motion = opening_of(patient);
  EXPECT_EQ(motion.name, "opening");
  EXPECT_FALSE(motion.recorded);
  for (const double time : {0.0, motion.duration_s, -1.0, 99.0}) {
    EXPECT_EQ(motion.target(time).t.norm(), 0);
    EXPECT_EQ(rotation_angle(motion.target(time)), 0);
  }
}

/// The thinning of a disc that the case states is no crushing.
TEST(Opening, AThinDiscInFrontOpensAsFarAsOneOfEvenThickness) {
  const Case patient = jaw_in_fossae();
  const double even = largest_opening(opening_of(patient), patient);
  MotionSettings thin;
  thin.parameters.disc_gap_front_mm = 1.0;  // 2 mm at rest
  EXPECT_NEAR(largest_opening(opening_of(patient, thin), patient), even, 1);
  EXPECT_GT(even, 35);
}

TEST(Opening, IsCancelledByItsProgress) {
  const Case patient = free_jaw();
  int reports = 0;
  MotionSettings settings;
  settings.progress = [&](std::string_view, double) {
    if (++reports == 3) throw std::runtime_error("cancelled");
  };
  EXPECT_THROW(opening_of(patient, settings), std::runtime_error);
  EXPECT_EQ(reports, 3);
}

TEST(Opening, StaysInTheBandsOfAdults) {
  const Case patient = free_jaw();
  const Motion motion = opening_of(patient);
  const Measures open = measure(patient, motion.target(0.5 * motion.duration_s));
  EXPECT_GT(open.rotation_deg, 28);
  EXPECT_LT(open.rotation_deg, 45);
  const double travel = (open.left_condyle - *patient.landmarks.find("left_condyle")).norm();
  EXPECT_GT(travel, 10);
  EXPECT_LT(travel, 20);
}

TEST(Opening, StartsAndStopsSmoothly) {
  const Case patient = free_jaw();
  const Motion motion = opening_of(patient);
  const int frames = 3000;
  const double widest = largest_opening(motion, patient);
  std::vector<double> drop;
  for (int i = 0; i <= frames; ++i)
    drop.push_back(measure(patient, motion.target(motion.duration_s * i / frames)).opening_mm);
  const double dt = motion.duration_s / frames;
  double fastest = 0, sharpest = 0;
  for (int i = 1; i < frames; ++i) {
    const double speed = (drop[i + 1] - drop[i - 1]) / (2 * dt);
    const double acceleration = (drop[i + 1] - 2 * drop[i] + drop[i - 1]) / (dt * dt);
    fastest = std::max(fastest, std::abs(speed));
    sharpest = std::max(sharpest, std::abs(acceleration));
  }
  EXPECT_NEAR(fastest, 1.875 * widest / (0.45 * motion.duration_s),
              20);          // least jerk: 1.875 of the mean
  EXPECT_LT(fastest, 373);  // slower than the fastest voluntary closing
  EXPECT_LT(std::abs(drop[3]), 1e-4);
  EXPECT_LT(std::abs(drop[frames - 3]), 1e-4);
  EXPECT_NEAR(sharpest, 5.77 * widest / std::pow(0.45 * motion.duration_s, 2), 1);
  // It opens, waits, and closes: one rise and one fall.
  for (int i = 1; i <= frames; ++i) {
    if (i < 0.45 * frames) {
      EXPECT_GE(drop[i], drop[i - 1] - 1e-12);
    }
    if (i > 0.56 * frames) {
      EXPECT_LE(drop[i], drop[i - 1] + 1e-12);
    }
  }
}

TEST(Opening, RotatesFirstUnlessEarlyTranslationIsRequested) {
  const Case patient = free_jaw();
  const Eigen::Vector3d seat = *patient.landmarks.find("left_condyle");
  double before = -1;
  for (const double fraction : {0.0, 0.5, 1.0}) {
    const Motion motion = opening_of(patient, early(fraction));
    double forward = -1;  // when the jaw has turned by 8 degrees
    for (int i = 0; forward < 0; ++i) {
      const Measures now = measure(patient, motion.target(motion.duration_s * i / 2000));
      if (now.rotation_deg >= 8) forward = seat.y() - now.left_condyle.y();
    }
    EXPECT_GT(forward, before);
    if (fraction == 0) {
      EXPECT_LT(forward, 1e-9);
    }
    before = forward;
  }
  EXPECT_GT(before, 2);
}

TEST(Opening, CondylesFollowTheKnownPathAndKeepTheirDistance) {
  const Case patient = free_jaw();
  const Motion motion = opening_of(patient);
  const Pchip path = path_of_case(*patient.condylar_path);
  const Eigen::Vector3d seat = *patient.landmarks.find("left_condyle");
  for (int i = 0; i <= 100; ++i) {
    const Measures now = measure(patient, motion.target(motion.duration_s * i / 100));
    EXPECT_NEAR(seat.z() - now.left_condyle.z(), path(seat.y() - now.left_condyle.y()), 1e-9);
    EXPECT_NEAR(now.left_condyle.z(), now.right_condyle.z(), 1e-9);
    EXPECT_NEAR((now.left_condyle - now.right_condyle).norm(), 101, 1e-9);
  }
}

TEST(Opening, CouplingIsOneAndAHalfDegreesPerMillimetreAfterTheHinge) {
  const Coupling coupling;
  EXPECT_EQ(coupling.forward_mm(5 * degree), 0);
  EXPECT_NEAR(coupling.forward_mm(33 * degree), 21 / 1.5, 1e-12);
  EXPECT_NEAR(coupling.forward_mm(45 * degree), longest_forward_mm, 1e-12);
  for (const double early : {0.0, 0.3, 1.0}) {
    const Coupling mixed{.early = early};
    for (double forward = 0.5; forward < 16; forward += 0.7)
      EXPECT_NEAR(mixed.forward_mm(mixed.theta(forward)), forward, 1e-9);
  }
}

TEST(Opening, AverageJointHasItsInclinationAndAFlatEnd) {
  const Pchip path = average_path();
  EXPECT_NEAR(std::atan2(path(5), 5) / degree, 40, 1e-6);
  EXPECT_EQ(path(0), 0);
  EXPECT_NEAR(path.derivative(18), 0, 1e-9);
  for (double s = 0.25; s <= 20; s += 0.25) EXPECT_GE(path(s), path(s - 0.25) - 1e-12);
}

TEST(Opening, CondylesInAFossaKeepADiscOfEvenThickness) {
  Case patient = jaw_in_fossae();
  patient.motion.disc_gap_front_mm = 2;
  auto joint = JointSurfaces::find(patient);
  ASSERT_TRUE(joint);
  EXPECT_NEAR(joint->rest_gap_mm(), 2, 0.05);
  const Motion motion = opening_of(patient);
  EXPECT_NEAR(largest(&Measures::incisal_displacement_mm, motion, patient), 46.6, 1e-3);
  double widest = 0;
  for (int i = 0; i <= 120; ++i) {
    const Pose X_CM = motion.target(0.5 * motion.duration_s * i / 120);
    EXPECT_GE(joint->slack_mm(X_CM), -0.1);
    widest = std::max(widest, joint->slack_mm(X_CM));
  }
  EXPECT_LT(widest, 0.3);  // guided, not merely clear
  // The path leans as the roof does: a slab at 35 degrees.
  const Measures open = measure(patient, motion.target(0.5 * motion.duration_s));
  const Eigen::Vector3d displacement = *patient.landmarks.find("left_condyle") - open.left_condyle;
  EXPECT_NEAR(std::atan2(displacement.z(), displacement.y()) / degree, 35, 1.5);
}

TEST(Opening, TheDiscIsThinnerOnTheEminence) {
  const Case patient = jaw_in_fossae();
  auto joint = JointSurfaces::find(patient);
  ASSERT_TRUE(joint);
  const double rest = joint->rest_gap_mm();
  EXPECT_NEAR(rest, 2, 0.05);
  const Motion motion = opening_of(patient);
  double least = 0;
  for (int i = 0; i <= 120; ++i)
    least = std::min(least, joint->slack_mm(motion.target(0.5 * motion.duration_s * i / 120)));
  EXPECT_NEAR(rest + least, 1.3, 0.1);
  // One that is thinner when seated keeps its thickness.
  Case narrow = patient;
  narrow.motion.disc_gap_mm = 1;
  const JawJoints joints(narrow, narrow.motion, JointReach::straight, 1);
  EXPECT_EQ(joints.disc_gap(JawSide::left).front_mm, 1);
}

TEST(Opening, AJawThatMeetsBoneStopsUnlessAnOpeningIsRequested) {
  Case patient = free_jaw();
  patient.condylar_path.reset();
  // A bar behind the chin: the body meets it at some 20 mm of opening.
  patient.parts[1].mesh =
      test::joined(patient.parts[1].mesh, test::box({-50, -60, -90}, {50, -50, -80}));
  const ContactModel contacts(patient);
  const Motion motion = make_motion("opening", patient, contacts);
  const double reached = largest_opening(motion, patient);
  EXPECT_GT(reached, 5);
  EXPECT_LT(reached, 40);
  ContactSet last = contacts.at_rest();
  for (int i = 0; i <= 120; ++i) {
    last = contacts.find(motion.target(motion.duration_s * i / 120), &last);
    EXPECT_FALSE(last.pairs[0].touching);
  }
  EXPECT_GT(motion.notes.size(), 1u);
  // Asked for more, it tries; contact will stop it.
  EXPECT_NEAR(largest_opening(make_motion("opening", patient, contacts, opening_by(40)), patient),
              40, 1e-3);
}

TEST(Opening, RefusesImpossibleValues) {
  Case patient = free_jaw();
  const ContactModel contacts(patient);
  const auto refused = [&](const MotionSettings& settings, const std::string& word) {
    try {
      make_motion("opening", patient, contacts, settings);
      ADD_FAILURE() << word;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  const double nan = std::nan("");
  refused(opening_by(200), "200");
  refused(opening_by(-5), "-5");
  refused(opening_by(nan), "nan");
  refused({.duration_s = -1}, "duration");
  refused({.duration_s = nan}, "duration");
  refused(early(3), "3");
  refused(early(nan), "nan");
  patient.landmarks.points.erase("left_condyle");
  refused({}, "left_condyle");
}

TEST(MakeMotion, KnowsItsNamesAndListsThemForAnUnknownOne) {
  const Case patient = free_jaw();
  const ContactModel contacts(patient);
  for (const auto& name : builtin_motions())
    EXPECT_EQ(make_motion(name, patient, contacts).name, name);
  for (const std::string spec : {"yawning", "", "Opening"}) {
    try {
      make_motion(spec, patient, contacts);
      ADD_FAILURE() << spec;
    } catch (const InputError& error) {
      for (const auto& name : builtin_motions())
        EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
    }
  }
  EXPECT_THROW(make_motion("absent.csv", patient, contacts), InputError);
  EXPECT_THROW(make_motion("no/such/file", patient, contacts), InputError);
}

/// Plays the opening without any correction: no pair may be deeper than at rest at any step.
void expect_free_opening(const Case& patient, double at_least_mm) {
  const ContactModel contacts(patient);
  const Motion motion = make_motion("opening", patient, contacts);
  auto joint = JointSurfaces::find(patient);
  ContactSet last = contacts.at_rest();
  double largest = 0;
  for (int i = 0; i <= 360; ++i) {
    const Pose X_CM = motion.target(motion.duration_s * i / 360);
    last = contacts.find(X_CM, &last, 2);
    for (std::size_t k = 0; k < last.pairs.size(); ++k) {
      const PairContact &now = last.pairs[k], &rest = contacts.at_rest().pairs[k];
      ASSERT_LE(now.depth_mm, rest.depth_mm + 0.005) << i;
      ASSERT_LE(now.touching, rest.touching) << i;
    }
    if (joint) {
      ASSERT_GT(joint->slack_mm(X_CM), -0.3 * joint->rest_gap_mm()) << i;
    }
    largest = std::max(largest, measure(patient, X_CM).opening_mm);
  }
  EXPECT_GE(largest, at_least_mm);
}

TEST(RealOpening, UbcOpensThirtyMillimetresFreely) {
  const auto patient = test::case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  ASSERT_TRUE(JointSurfaces::find(*patient));  // its fossa guides it
  expect_free_opening(*patient, 30);
}

TEST(RealOpening, BadinOpensFortyMillimetresFreely) {
  const auto patient = test::case_badin();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  expect_free_opening(*patient, 40);
}

}  // namespace
}  // namespace condyle::test
