#include "sim/plan/movement_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "engine/core/units.h"
#include "sim/plan/columns.h"
#include "sim/plan/move.h"
#include "tests/sim/plan/marks.h"

using namespace condyle;
using Eigen::Vector3d;

namespace {

/// cranium <- mandible <- chin, and the maxilla.
struct Operated {
  BodyTree bodies = native_bodies();
  BodyId maxilla = bodies.add({.name = "maxilla", .driver = BodyDriver::plan});
  BodyId chin = bodies.add({.name = "chin", .parent = mandible_body, .driver = BodyDriver::plan});
  Landmarks marks = test::upright_marks();
  LandmarkOwners owners;

  Operated() {
    marks.points["lower_incisal_point"] = {0.5, -92, -51};
    marks.points["upper_left_first_molar_mesiobuccal_cusp"] = {25, -65, -50};
    marks.points["upper_right_first_molar_mesiobuccal_cusp"] = {-25, -65, -50};
    marks.points["left_condyle"] = {50, -13, -7};
    marks.points["right_condyle"] = {-50, -13, -7};
    owners = default_landmark_owners({.upper_arch = maxilla});
    owners["pogonion"] = chin;
  }
  MovementTable table(const BodyPoses& poses) const {
    return movement_table(marks, {}, bodies, owners, poses);
  }
};

const MovementRow& row_of(const MovementTable& table, const std::string& label) {
  for (const auto& row : table.rows)
    if (row.label == label) return row;
  throw std::runtime_error("no row " + label);
}

}  // namespace

TEST(MovementTable, OnlyLandmarksThatTheCaseHasInTheOrderOfPlanners) {
  const Operated patient;
  std::vector<std::string> labels;
  for (const auto& row : patient.table({}).rows) {
    labels.push_back(row.label);
    EXPECT_EQ(row.distance_mm(), 0);
  }
  EXPECT_EQ(labels, (std::vector<std::string>{"U1", "U6 right", "U6 left", "PNS", "L1", "Pog",
                                              "Co right", "Co left"}));
}

// Patient 1 of the paper: upper incisors forward 4 and up 2, posterior nasal spine up 4.
TEST(MovementTable, ImpactedMaxilla) {
  const Operated patient;
  const Vector3d u1 = patient.marks.points.at("upper_incisal_point");
  const ClinicalMove move =
      with_height({.forward_mm = 4, .up_mm = 2}, {}, u1, patient.marks.points.at("pns"), 4);
  BodyPoses poses;
  poses[patient.maxilla] = move_pose(move, {}, u1);
  const MovementTable table = patient.table(poses);
  const MovementRow& tip = row_of(table, "U1");
  EXPECT_NEAR(tip.left_mm, 0, 1e-12);
  EXPECT_NEAR(tip.back_mm, -4, 1e-12);
  EXPECT_NEAR(tip.up_mm, 2, 1e-12);
  EXPECT_NEAR(tip.distance_mm(), std::sqrt(20), 1e-12);
  EXPECT_NEAR(row_of(table, "PNS").up_mm, 4, 1e-12);
  // A molar 30 mm behind the incisors rises by 2 mm + 30 sin(pitch) and a little of its height.
  EXPECT_NEAR(row_of(table, "U6 left").up_mm, 2 + 30 * std::sin(move.pitch_deg * degree), 0.01);
  EXPECT_EQ(row_of(table, "L1").distance_mm(), 0);
  ASSERT_EQ(table.rotations.size(), 3u);
  EXPECT_EQ(table.rotations[1].body, "maxilla");
  EXPECT_NEAR(table.rotations[1].pitch_deg, move.pitch_deg, 1e-12);
  EXPECT_NEAR(table.rotations[1].yaw_deg, 0, 1e-12);
  EXPECT_EQ(table.rotations[0].pitch_deg, 0);
}

TEST(MovementTable, SegmentsOfAMovedBodyGoWithIt) {
  const Operated patient;
  BodyPoses poses;  // ends before the chin, which is then at rest on the mandible
  poses[mandible_body].t = {1, 5, -2};
  const MovementTable table = patient.table(poses);
  EXPECT_EQ(row_of(table, "Pog").back_mm, 5);
  EXPECT_EQ(row_of(table, "Co left").left_mm, 1);
  EXPECT_EQ(row_of(table, "U1").distance_mm(), 0);
}

TEST(MovementTable, MidlinesAndCant) {
  const Operated patient;
  const Vector3d u1 = patient.marks.points.at("upper_incisal_point");
  BodyPoses poses;
  poses[patient.maxilla] = move_pose({.left_mm = -1.5, .roll_deg = 2}, {}, u1);
  const MovementTable table = patient.table(poses);
  ASSERT_EQ(table.midlines.size(), 4u);
  EXPECT_NEAR(table.midlines[0].before_mm, 0, 1e-12);
  EXPECT_NEAR(table.midlines[0].after_mm, -1.5, 1e-12);
  EXPECT_EQ(table.midlines[1].after_mm, 0.5);
  EXPECT_EQ(table.midlines[3].label, "cant U6");
  EXPECT_NEAR(table.midlines[3].before_mm, 0, 1e-12);
  EXPECT_NEAR(table.midlines[3].after_mm, 50 * std::sin(2 * degree), 1e-12);
}

TEST(MovementTable, TextHasDirectionsInWords) {
  const Operated patient;
  const Vector3d u1 = patient.marks.points.at("upper_incisal_point");
  BodyPoses poses;
  poses[patient.maxilla] =
      move_pose({.left_mm = -1, .forward_mm = 4, .up_mm = 2, .pitch_deg = 3}, {}, u1);
  const std::string text = movement_text(patient.table(poses));
  EXPECT_NE(text.find("U1        1.0 right   4.0 forward   2.0 up        4.6\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("maxilla   0.0  3.0 front down  0.0\n"), std::string::npos) << text;
  EXPECT_NE(text.find("upper midline  0.0       1.0 right\n"), std::string::npos) << text;
  const auto json = movement_json(patient.table(poses));
  EXPECT_NEAR(json["landmarks"][0]["forward_mm"].get<double>(), 4, 1e-12);
  EXPECT_NEAR(json["landmarks"][0]["left_mm"].get<double>(), -1, 1e-12);
  EXPECT_EQ(json["segments"][1]["name"], "maxilla");
  EXPECT_NEAR(json["segments"][1]["pitch_deg"].get<double>(), 3, 1e-12);
}

TEST(Columns, AreAlignedByCharacters) {
  EXPECT_EQ(aligned_columns({{"a", "1.0"}, {"±b", "12.5"}, {"c"}}, "lr"),
            "a    1.0\n±b  12.5\nc\n");
}
