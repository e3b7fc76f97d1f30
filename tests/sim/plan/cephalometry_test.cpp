#include "sim/plan/cephalometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "engine/core/units.h"
#include "tests/sim/plan/marks.h"
#include "tests/support/builtin.h"

using namespace condyle;
using Eigen::Vector3d;

namespace {

const CephalometricMeasure& measure_of(const std::vector<CephalometricMeasure>& measures,
                                       const std::string& name) {
  for (const auto& measure : measures)
    if (measure.name == name) return measure;
  throw std::runtime_error("no measure " + name);
}

/// A point of the profile: mm in front of and above the origin.
Vector3d sagittal(double forward, double up) { return {0, -forward, up}; }

void put_pair(Landmarks& marks, const std::string& before_side, const std::string& after_side,
              double forward, double up, double left = 30) {
  marks.points[before_side + "left" + after_side] = {left, -forward, up};
  marks.points[before_side + "right" + after_side] = {-left, -forward, up};
}

/// A profile of whole angles: Frankfort level at z = 0, SN level at z = 30.
Landmarks drawn_profile() {
  Landmarks marks;
  auto& p = marks.points;
  put_pair(marks, "", "_porion", 0, 0);
  put_pair(marks, "", "_orbitale", 80, 0);
  p["sella"] = sagittal(20, 30);
  p["nasion"] = sagittal(90, 30);
  const auto below = [](const Vector3d& from, double length, double angle_deg) {
    // angle_deg from straight down, positive towards the front
    return Vector3d(from +
                    length * sagittal(std::sin(angle_deg * degree), -std::cos(angle_deg * degree)));
  };
  p["a_point"] = below(p["nasion"], 60, -8);     // SNA 82
  p["b_point"] = below(p["nasion"], 100, -10);   // SNB 80
  p["pogonion"] = below(p["a_point"], 50, -13);  // convexity -8 + 13 = 5
  p["menton"] = sagittal(75, -90);
  // Go-Me slopes by 25 degrees, Go-Gn by 20.
  put_pair(marks, "", "_gonion", 75 - 70, -90 + 70 * std::tan(25 * degree));
  p["gnathion"] = sagittal(5 + 75, p["left_gonion"].z() - 75 * std::tan(20 * degree));
  p["ans"] = sagittal(95, -24);  // 54 of 120 mm
  // The incisors 111 degrees to Frankfort, 90 to the mandibular plane.
  p["upper_incisal_point"] = sagittal(95, -53);
  p["lower_incisal_point"] = sagittal(92, -51);
  const Vector3d upper = p["upper_incisal_point"] - below(Vector3d::Zero(), 22, 111 - 90);
  put_pair(marks, "upper_", "_central_incisor_apex", -upper.y(), upper.z(), 4);
  const Vector3d lower =
      p["lower_incisal_point"] -
      20 * sagittal(std::sin(25 * degree), std::cos(25 * degree));  // across the plane
  put_pair(marks, "lower_", "_central_incisor_apex", -lower.y(), lower.z(), 4);
  // A functional occlusal plane that falls by 10 degrees in front.
  const double c = std::cos(10 * degree), s = std::sin(10 * degree);
  put_pair(marks, "upper_", "_canine_tip", 85 - s, -52 - c);
  put_pair(marks, "lower_", "_canine_tip", 85 + s, -52 + c);
  put_pair(marks, "upper_", "_first_molar_mesiobuccal_cusp", 85 - 25 * c - s, -52 + 25 * s - c);
  put_pair(marks, "lower_", "_first_molar_mesiobuccal_cusp", 85 - 25 * c + s, -52 + 25 * s + c);
  // Soft tissue: 12 degrees of convexity, 100 of the nasolabial angle.
  p["soft_glabella"] = sagittal(100, 40);
  p["subnasale"] = below(p["soft_glabella"], 70, 8);
  p["soft_pogonion"] = below(p["subnasale"], 55, -4);
  p["columella"] = p["subnasale"] + 8 * sagittal(1, 0);
  p["labrale_superius"] = below(p["subnasale"], 15, 10 - 20);   // 100 degrees from forward
  p["pronasale"] = sagittal(p["soft_pogonion"].y() * -1, -15);  // an E line straight down
  p["labrale_inferius"] = p["soft_pogonion"] + sagittal(1.5, 20);
  return marks;
}

}  // namespace

TEST(Cephalometry, ADrawnProfileHasTheAnglesItWasDrawnWith) {
  const Landmarks marks = drawn_profile();
  const ClinicalFrame frame{.origin = marks.points.at("nasion")};
  const auto measures = cephalometry(frame, marks, marks);
  const auto expect = [&](const char* name, double value) {
    const auto& measure = measure_of(measures, name);
    ASSERT_TRUE(measure.before) << name;
    EXPECT_NEAR(*measure.before, value, 1e-9) << name;
    EXPECT_EQ(measure.change(), 0) << name;
    EXPECT_TRUE(measure.missing.empty());
  };
  expect("SNA", 82);
  expect("SNB", 80);
  expect("ANB", 2);
  expect("SN to Go-Gn", 20);
  expect("FMA (Frankfort to Go-Me)", 25);
  expect("convexity (NA to APog)", 5);
  expect("A to N-perpendicular", -60 * std::sin(8 * degree));
  const double pog = -60 * std::sin(8 * degree) - 50 * std::sin(13 * degree);
  const double pog_down = 60 * std::cos(8 * degree) + 50 * std::cos(13 * degree);
  expect("Pog to N-perpendicular", pog);
  expect("facial angle (Frankfort to N-Pog)", 90 + std::atan(pog / pog_down) * degrees_per_radian);
  expect("N-ANS of N-Me", 45);
  expect("overjet", 3);
  expect("overbite", 2);
  expect("U1 to Frankfort", 111);
  expect("U1 to SN", 111);
  expect("IMPA (L1 to Go-Me)", 90);
  expect("FMIA (L1 to Frankfort)", 65);
  expect("interincisal angle", 180 - 111 + 65);
  const double c = std::cos(10 * degree), s = std::sin(10 * degree);
  const Vector3d ab = marks.points.at("a_point") - marks.points.at("b_point");
  expect("Wits", -ab.y() * c - ab.z() * s);
  expect("facial convexity (G-Sn-Pog')", 12);
  expect("nasolabial angle", 100);
  const auto& p = marks.points;
  expect("upper lip to E line", p.at("soft_pogonion").y() - p.at("labrale_superius").y());
  expect("lower lip to E line", 1.5);
  EXPECT_EQ(measures.size(), 22u);
}

TEST(Cephalometry, DoesNotDependOnWhereTheHeadIs) {
  const Landmarks marks = drawn_profile();
  Landmarks turned = marks;
  const Eigen::Quaterniond R(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) *
                             Eigen::AngleAxisd(-0.2, Vector3d::UnitX()));
  for (auto& [name, point] : turned.points) point = R * point + Vector3d(10, 300, -50);
  const ClinicalFrame straight{.origin = marks.points.at("nasion")};
  const ClinicalFrame there{.left = R * Vector3d::UnitX(),
                            .back = R * Vector3d::UnitY(),
                            .up = R * Vector3d::UnitZ(),
                            .origin = turned.points.at("nasion")};
  const auto a = cephalometry(straight, marks, marks), b = cephalometry(there, turned, turned);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(*a[i].before, *b[i].before, 1e-9);
}

// The maxilla advanced by 4 mm, the mandible set back by 5: overjet and the jaws' angles follow.
TEST(Cephalometry, BeforeAndAfter) {
  const Landmarks before = drawn_profile();
  Landmarks after = before;
  for (const char* name : {"a_point", "upper_incisal_point"}) after.points[name].y() -= 4;
  for (const char* name : {"b_point", "pogonion", "lower_incisal_point"})
    after.points[name].y() += 5;
  const auto measures = cephalometry({}, before, after);
  EXPECT_NEAR(*measure_of(measures, "overjet").change(), 9, 1e-12);
  EXPECT_NEAR(*measure_of(measures, "overbite").change(), 0, 1e-12);
  EXPECT_NEAR(*measure_of(measures, "A to N-perpendicular").change(), 4, 1e-12);
  EXPECT_NEAR(*measure_of(measures, "Pog to N-perpendicular").change(), -5, 1e-12);
  // A lies 60 cos 8 below nasion.
  const double down = 60 * std::cos(8 * degree), back = 60 * std::sin(8 * degree);
  EXPECT_NEAR(*measure_of(measures, "SNA").after,
              90 - std::atan((back - 4) / down) * degrees_per_radian, 1e-9);
  EXPECT_LT(*measure_of(measures, "SNB").change(), -2.5);
}

// Asymmetric points: ANB is the difference of the projected angles.
TEST(Cephalometry, IsMeasuredOnTheProjection) {
  Landmarks marks = drawn_profile();
  const auto straight = cephalometry({}, marks, marks);
  marks.points["a_point"].x() = 12;
  marks.points["left_gonion"] += Vector3d(3, 4, -6);
  marks.points["right_gonion"] += Vector3d(3, -4, 6);
  const auto crooked = cephalometry({}, marks, marks);
  for (std::size_t i = 0; i < straight.size(); ++i)
    EXPECT_NEAR(*straight[i].before, *crooked[i].before, 1e-9) << straight[i].name;
}

TEST(Cephalometry, MissingLandmarksAreNamed) {
  Landmarks marks = drawn_profile();
  marks.points.erase("a_point");
  marks.points.erase("left_gonion");
  const auto measures = cephalometry({}, marks, marks);
  const auto& anb = measure_of(measures, "ANB");
  EXPECT_FALSE(anb.before);
  EXPECT_FALSE(anb.after);
  EXPECT_FALSE(anb.change());
  EXPECT_EQ(anb.missing, std::vector<std::string>{"a_point"});
  EXPECT_EQ(measure_of(measures, "IMPA (L1 to Go-Me)").missing,
            std::vector<std::string>{"left_gonion"});
  EXPECT_TRUE(measure_of(measures, "SNB").before);
  EXPECT_EQ(cephalometry({}, {}, {}).size(), measures.size());
  // Points that coincide have no angle.
  marks = drawn_profile();
  marks.points["b_point"] = marks.points["nasion"];
  marks.points["left_orbitale"] = marks.points["left_porion"];
  marks.points["right_orbitale"] = marks.points["right_porion"];
  const auto coinciding = cephalometry({}, marks, marks);
  EXPECT_FALSE(measure_of(coinciding, "SNB").before);
  EXPECT_FALSE(measure_of(coinciding, "A to N-perpendicular").before);
  EXPECT_TRUE(measure_of(coinciding, "A to N-perpendicular").missing.empty());
  // A landmark that only the operated patient lacks.
  Landmarks after = drawn_profile();
  after.points.erase("soft_pogonion");
  const auto half = cephalometry({}, drawn_profile(), after);
  EXPECT_TRUE(measure_of(half, "lower lip to E line").before);
  EXPECT_FALSE(measure_of(half, "lower lip to E line").after);
  EXPECT_NE(cephalometry_text(half).find("lower lip to E line: soft_pogonion"), std::string::npos);
}

TEST(Cephalometry, TextAndJsonShowNormsWithTheirSource) {
  Landmarks marks = drawn_profile();
  marks.points.erase("columella");
  const auto measures = cephalometry({}, marks, marks);
  const std::string text = cephalometry_text(measures);
  EXPECT_NE(text.find("82 ± 3.5  Steiner 1953; textbook value"), std::string::npos) << text;
  EXPECT_NE(text.find("-4 to 2 "), std::string::npos) << text;
  EXPECT_NE(text.find("nasolabial angle: columella\n"), std::string::npos) << text;
  const auto json = cephalometry_json(measures);
  EXPECT_EQ(json[0]["name"], "SNA");
  EXPECT_NEAR(json[0]["before"].get<double>(), 82, 1e-9);
  EXPECT_EQ(json[0]["norm"]["sd"], 3.5);
  for (const auto& item : json) {
    EXPECT_FALSE(item["norm"]["source"].get<std::string>().empty());
    if (item["name"] == "nasolabial angle") {
      EXPECT_TRUE(item["before"].is_null());
      EXPECT_EQ(item["missing"][0], "columella");
    }
  }
}

// Values that were measured on the built-in patient before this module existed.
TEST(Cephalometry, TheBuiltInPatientIsNormal) {
  const Landmarks& marks = test::builtin().landmarks;
  const auto measures = cephalometry(clinical_frame(marks), marks, marks);
  const auto expect = [&](const char* name, double value) {
    const auto& measure = measure_of(measures, name);
    ASSERT_TRUE(measure.before) << name;
    EXPECT_NEAR(*measure.before, value, 0.11) << name;  // given to one decimal, by another program
  };
  expect("SNA", 83.7);
  expect("SNB", 81.2);
  expect("ANB", 2.5);
  expect("FMA (Frankfort to Go-Me)", 22.3);
  expect("convexity (NA to APog)", 1.5);
  expect("facial convexity (G-Sn-Pog')", 12.5);
  expect("overjet", 2.7);
  expect("overbite", 2.3);
}
