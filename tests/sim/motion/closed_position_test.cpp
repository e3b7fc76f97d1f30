// Patients that were scanned with the mouth open: openings count from the closed position.

#include "sim/motion/closed_position.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/units.h"
#include "sim/motion/measure_pose.h"
#include "sim/motion/motion.h"
#include "tests/sim/motion/jaws.h"
#include "tests/support/builtin.h"
#include "tests/support/scanned_open.h"

namespace condyle::test {
namespace {

double scan_opening(const Case& patient) { return measure(patient, {}).opening_mm; }

Measures at_widest(const Case& patient, const Motion& motion) {
  constexpr int frames = 360;
  Measures widest;
  for (int i = 0; i <= frames; ++i)
    if (const auto now = measure(patient, motion.target(motion.duration_s * i / frames));
        now.opening_mm > widest.opening_mm)
      widest = now;
  return widest;
}

struct Patient {
  Case closed, open;
  double scan_mm;  // descent of the incisal point between them
};

Patient builtin_scanned_open() {
  Patient made{builtin(), scanned_open(builtin(), 5), 0};
  made.scan_mm = made.closed.landmarks.find("lower_incisal_point")->z() -
                 made.open.landmarks.find("lower_incisal_point")->z();
  locate_closed_position(made.closed);
  locate_closed_position(made.open);
  return made;
}

TEST(ClosedPosition, IsTheRestPoseWhereTheTeethMeet) {
  EXPECT_EQ(scan_opening(builtin_scanned_open().closed), 0);
  Case patient = jaw_with_teeth();
  locate_closed_position(patient);
  EXPECT_EQ(scan_opening(patient), 0);
}

TEST(ClosedPosition, IsFoundWhereTheTeethAreApart) {
  const auto [closed, open, scan_mm] = builtin_scanned_open();
  ASSERT_GT(scan_mm, 6);
  EXPECT_NEAR(scan_opening(open), scan_mm, 0.5);
  EXPECT_NEAR(rotation_angle(open.X_CM_closed) / degree, 5, 0.3);
}

TEST(ClosedPosition, OpeningsOfAnOpenScanEndWhereThoseOfAClosedOneDo) {
  const auto [closed, open, scan_mm] = builtin_scanned_open();
  const ContactModel contacts_closed(closed), contacts_open(open);
  const auto both = [&](const std::string& motion) {
    return std::pair(at_widest(closed, make_motion(motion, closed, contacts_closed)),
                     at_widest(open, make_motion(motion, open, contacts_open)));
  };
  for (const char* motion : {"opening", "open 30"}) {
    const auto [expected, found] = both(motion);
    EXPECT_NEAR(found.opening_mm, expected.opening_mm, 0.7) << motion;
    EXPECT_NEAR(found.interincisal_mm, expected.interincisal_mm, 0.7) << motion;
    EXPECT_NEAR(found.rotation_deg, expected.rotation_deg, 1) << motion;
    EXPECT_NEAR(found.left_condyle_travel_mm, expected.left_condyle_travel_mm, 1) << motion;
  }
  const Motion opening = make_motion("open 30", open, contacts_open);
  EXPECT_NEAR(at_widest(open, opening).opening_mm, 30, 0.01);
  const Motion closing = make_motion("open 20; close; protrude 5", open, contacts_open);
  const auto phase_end = [&](std::size_t i) {
    return measure(open, closing.target(closing.phases.at(i).end_s));
  };
  EXPECT_NEAR(phase_end(1).opening_mm, 0, 0.02);
  EXPECT_NEAR(phase_end(2).protrusion_mm, 5, 0.05);
}

TEST(ClosedPosition, IsNotedByTheMotionAndTheImport) {
  Case open = scanned_open(builtin(), 5);
  report_scan_opening(open);
  ASSERT_FALSE(open.notes.empty());
  EXPECT_NE(open.notes.back().find("the mouth was open by"), std::string::npos);
  const Motion motion = make_motion("opening", open, ContactModel(open));
  EXPECT_TRUE(std::any_of(motion.notes.begin(), motion.notes.end(), [](const auto& note) {
    return note.find("the closed position, from where openings and rotations count") !=
           std::string::npos;
  }));
}

TEST(ClosedPosition, IsDeclaredWhereTheTeethDoNotShowIt) {
  Case patient = free_jaw();  // its teeth are parts of the bones
  patient.scan_opening_mm = 6;
  locate_closed_position(patient);
  EXPECT_NEAR(scan_opening(patient), 6, 1e-6);
  EXPECT_NEAR(at_widest(patient, make_motion("open 25", patient, ContactModel(patient))).opening_mm,
              25, 1e-3);
  patient.scan_opening_mm = 0;  // an open bite
  locate_closed_position(patient);
  EXPECT_EQ(scan_opening(patient), 0);
  patient.landmarks.points["lower_incisal_point"] = {0, -15, -50};  // the jaw cannot rise so far
  patient.scan_opening_mm = 59;
  EXPECT_THROW(locate_closed_position(patient), InputError);
}

}  // namespace
}  // namespace condyle::test
