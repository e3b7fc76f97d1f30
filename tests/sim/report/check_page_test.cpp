#include "sim/report/check_page.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "sim/report/clearance.h"
#include "tests/support/boxes.h"
#include "tests/support/real_cases.h"
#include "tests/support/shapes.h"

namespace condyle::test {
namespace {

/// Up by `height_mm` and back again within a second.
Motion bite(double height_mm) {
  return {"bite",
          1,
          true,
          [height_mm](double t) {
            Pose pose;
            pose.t = {0, 0, height_mm * (1 - std::abs(2 * std::clamp(t, 0.0, 1.0) - 1))};
            return pose;
          },
          {}};
}

/// A ball on the left half of the mandible that meets a flat maxilla 1 mm above it.
Case ball_patient() {
  Case patient = box_patient();
  patient.name = "ball <& box>";
  patient.parts[0].mesh = box({-30, -90, -40}, {30, -40, 0});
  patient.parts[1].mesh = sphere(5, 12, {15, -65, -53});
  return patient;
}

/// The bite lasts a second: its turning point is a frame.
CheckSettings at_120_hz(double margin_mm) { return {.margin_mm = margin_mm, .sampling = {121, 0}}; }

TEST(CheckedPair, BallInABoxHasTheCapsAreaAndVolume) {
  const Scene scene = make_scene(ball_patient());
  const Motion motion = bite(3);
  const auto check = check_clearance(scene, motion, at_120_hz(0), {});
  const auto& pair = check.pairs.at(0);
  EXPECT_EQ(pair.worst.when.frame, 60);
  EXPECT_NEAR(pair.beyond_rest_mm, 2, 0.01);
  const double area = 2 * std::numbers::pi * 12 * 2.1;
  const double volume = std::numbers::pi * 4 * (3 * 12 - 2) / 3;
  EXPECT_NEAR(pair.worst.measure.area_mm2, area, 0.02 * area);
  EXPECT_NEAR(pair.worst.measure.volume_mm3, volume, 0.02 * volume);
  EXPECT_EQ(pair.worst.measure.patches, 1);
  EXPECT_EQ(pair.worst.measure.side, "left");
  EXPECT_LT((pair.worst.measure.place - Eigen::Vector3d(15, -65, -38)).norm(), 0.2);
  EXPECT_LT((pair.worst.measure.normal - Eigen::Vector3d(0, 0, -1)).norm(), 0.02);
  // Up 6 mm/s: it touches for the two thirds of the time that it is higher than 1 mm.
  EXPECT_EQ(pair.touches, 1);
  EXPECT_NEAR(pair.touching_frames / 121.0, 2.0 / 3, 0.02);
  // When it first touches is found between the frames.
  EXPECT_NEAR(pair.first_touch->time_s, 1.0 / 6, 0.02 / 6);
  EXPECT_NEAR(pair.first_touch->frame, 20.5, 0.6);

  const auto json = nlohmann::json::parse(check.json(scene, motion, {"worst.png"}, {"a note"}));
  const auto& worst = json["pairs"][0]["worst"];
  EXPECT_EQ(worst["frame"], 60);
  EXPECT_EQ(worst["picture"], "worst.png");
  EXPECT_EQ(worst["side"], "left");
  EXPECT_NEAR(worst["penetration_volume_mm3"].get<double>(), volume, 0.02 * volume);
  EXPECT_NEAR(json["pairs"][0]["contact_frequency"].get<double>(), 2.0 / 3, 0.02);
  EXPECT_FALSE(json["coronoid_zygoma"]["available"].get<bool>());
  EXPECT_EQ(json["notes"].back(), "a note");
}

TEST(CheckedPair, OpenSurfaceHasNoVolume) {
  Case patient = ball_patient();
  patient.parts[0].mesh.triangles.resize(2);  // the lower face alone
  const Scene scene = make_scene(std::move(patient));
  const auto check = check_clearance(scene, bite(3), at_120_hz(0), {});
  const auto& pair = check.pairs.at(0);
  EXPECT_TRUE(pair.worst.measure.open_a);
  EXPECT_FALSE(pair.worst.measure.volume_known);
  EXPECT_GT(pair.worst.measure.area_mm2, 0);
  // The ball still has an inside, and the sheet's deepest point in it is known.
  EXPECT_LT((pair.worst.measure.place - Eigen::Vector3d(15, -65, -40)).norm(), 0.3);
  const auto json = nlohmann::json::parse(check.json(scene, bite(3)));
  EXPECT_TRUE(json["pairs"][0]["worst"]["penetration_volume_mm3"].is_null());
  EXPECT_NE(check_page(check, {"p", "m", {"x.png"}, {}}).find("unsigned"), std::string::npos);
}

TEST(WorstView, DistancesOnTheBallAreItsHeights) {
  const Scene scene = make_scene(ball_patient());
  const auto check = check_clearance(scene, bite(3), at_120_hz(0), {});
  const WorstView view = worst_view(scene, check.pairs.at(0), 2);
  ASSERT_EQ(view.parts.size(), 2u);
  ASSERT_EQ(view.distance_a.size(), view.parts[0].mesh.vertices.size());
  ASSERT_EQ(view.distance_b.size(), view.parts[1].mesh.vertices.size());
  int inside = 0, near_box = 0;
  for (std::size_t i = 0; i < view.distance_b.size(); ++i) {
    const double height = view.parts[1].mesh.vertices[i].z() + 3 + 40;
    if (height < -5.9) continue;
    EXPECT_NEAR(view.distance_b[i], -height, 1e-5);
    inside += height > 0;
  }
  // The box has eight corners; the picture needs many more where the ball is.
  const Eigen::Vector3d center(15, -65, -50);
  for (std::size_t i = 0; i < view.distance_a.size(); ++i) {
    if (!std::isfinite(view.distance_a[i])) continue;
    EXPECT_NEAR(view.distance_a[i], (view.parts[0].mesh.vertices[i] - center).norm() - 12, 0.02);
    ++near_box;
  }
  EXPECT_GT(inside, 100);
  EXPECT_GT(near_box, 1000);
}

TEST(Coronoid, ClearanceFromABeamBesideTheTip) {
  Case patient = box_patient();
  patient.parts[1].mesh = box({40, -40, -60}, {44, -30, -20});
  patient.parts.push_back({"skull", Role::skull, box({50, -60, -40}, {55, -25, -10}), {}});
  patient.landmarks.points["left_coronoid_tip"] = {42, -35, -20};
  const CoronoidClearance clearance(patient);
  ASSERT_EQ(clearance.sides().size(), 1u);
  EXPECT_EQ(clearance.sides()[0].side, "left");
  EXPECT_FALSE(clearance.sides()[0].estimated);
  EXPECT_NE(clearance.missing().find("right_coronoid_tip"), std::string::npos);
  CoronoidSide side = clearance.sides()[0];
  TrianglePair start;
  for (const double left : {0.0, 2.5, 1.0}) {
    Pose pose;
    pose.t.x() = left;
    side.mm.push_back(clearance.distance_mm(0, pose, start));
  }
  EXPECT_NEAR(side.mm[0], 6, 1e-9);
  EXPECT_NEAR(side.min_mm(), 3.5, 1e-9);
  EXPECT_EQ(side.min_frame(), 1);
}

TEST(CheckPage, SaysEachSentenceOnceAndNamesProgramDateAndSurfaces) {
  const Scene scene = make_scene(ball_patient());
  const auto check = check_clearance(scene, bite(0.5), at_120_hz(0), {});
  ASSERT_FALSE(check.violated());
  CheckPage of{scene.patient.name, "bite", {"worst.png"}, {}};
  EXPECT_EQ(check_page(check, of).find("Made by"), std::string::npos);
  of.program = "Condyle 1.2";
  of.date = "2026-11-24 10:00 UTC";
  of.surfaces = {"maxilla 0123", "mandible 4567"};
  const std::string page = check_page(check, of);
  const auto count = [&](const std::string& words) {
    int found = 0;
    for (std::size_t at = 0; (at = page.find(words, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  const PairVerdict& pair = check.pairs.at(0);
  EXPECT_EQ(count(worst_moment(pair)), 1);
  EXPECT_EQ(count(worst_place(pair)), 1);
  EXPECT_EQ(count(fmt::format("{:.2f} mm apart", pair.min_distance_mm)),
            1 + (fmt::format("{:.2f}", pair.rest_distance_mm) ==
                 fmt::format("{:.2f}", pair.min_distance_mm)));  // in the table, too
  EXPECT_EQ(count("Made by Condyle 1.2 on 2026-11-24 10:00 UTC."), 1);
  EXPECT_EQ(count("maxilla 0123, mandible 4567."), 1);
  EXPECT_EQ(count("<img src=\"worst.png\""), 1);
  EXPECT_EQ(count("<figcaption>"), 0);  // pictures contain their titles
  EXPECT_EQ(count("closest first"), 1);
  EXPECT_EQ(count("worst first"), 0);
  EXPECT_EQ(count("@media print"), 1);
}

TEST(CheckPage, StatesTheVerdictFirstAndEscapesNames) {
  const Scene scene = make_scene(ball_patient());
  const auto bad = check_clearance(scene, bite(3), at_120_hz(0.5), {});
  const auto page = check_page(bad, {scene.patient.name, "bite", {"worst.png"}, {"a < b"}});
  const auto at = [&](const char* text) { return page.find(text); };
  EXPECT_NE(at("Violation."), std::string::npos);
  EXPECT_LT(at("Violation."), at("<h1>"));
  EXPECT_LT(at("<h1>"), at("worst.png"));
  EXPECT_LT(at("worst.png"), at("<svg"));
  EXPECT_LT(at("<svg"), at("<table>"));
  EXPECT_NE(at("Not available: left"), std::string::npos);
  EXPECT_NE(at("not for clinical use"), std::string::npos);
  EXPECT_NE(at("ball &lt;&amp; box&gt;"), std::string::npos);
  EXPECT_NE(at("a &lt; b"), std::string::npos);
  EXPECT_EQ(at("<script"), std::string::npos);
  Case alone = ball_patient();
  alone.parts.erase(alone.parts.begin());
  const Scene no_pair = make_scene(std::move(alone));
  const auto nothing = check_clearance(no_pair, bite(3), at_120_hz(0.5), {});
  EXPECT_NE(check_page(nothing, {"p", "m", {}, {}}).find("Nothing to check"), std::string::npos);
  const auto good = check_clearance(scene, bite(0.3), at_120_hz(0.5), {});
  EXPECT_NE(check_page(good, {"p", "m", {}, {}}).find("No violation."), std::string::npos);
}

TEST(ClearancePlot, OpeningIsDrawnThroughAndClosingDashed) {
  const Scene scene = make_scene(ball_patient());
  const auto count = [](const std::string& text, const std::string& what) {
    int n = 0;
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
    return n;
  };
  // Down by 8 mm and back.
  const auto opening = clearance_svg(check_clearance(scene, bite(-8), at_120_hz(1), {}));
  EXPECT_NE(opening.find("Clearance against opening"), std::string::npos);
  EXPECT_NE(opening.find("margin 1.00 mm"), std::string::npos);
  EXPECT_EQ(count(opening, "<polyline"), 2);
  EXPECT_EQ(count(opening, "stroke-dasharray=\"6 4\""), 1);
  const auto still = clearance_svg(check_clearance(scene, bite(0.5), at_120_hz(0), {}));
  EXPECT_NE(still.find("Clearance over time"), std::string::npos);
  EXPECT_EQ(count(still, "stroke-dasharray=\"6 4\""), 0);
}

TEST(CheckPage, PartsAreNamedAsPeopleReadThem) {
  Case patient = ball_patient();
  patient.parts[0].name = "upper_jaw";
  const Scene scene = make_scene(std::move(patient));
  const auto check = check_clearance(scene, bite(3), at_120_hz(0.5), {});
  const auto page = check_page(check, {"p", "m", {}, {}});
  EXPECT_NE(page.find("<strong>upper jaw and mandible</strong>"), std::string::npos);
  EXPECT_NE(page.find("Upper jaw / mandible"), std::string::npos) << "in the plot";
  EXPECT_EQ(page.find("upper_jaw"), std::string::npos);
  EXPECT_EQ(check.pairs.at(0).a, "upper_jaw") << "files keep it";
}

TEST(Clearance, ContactAwayFromTheOverlapAtRestHasItsOwnDepth) {
  // A tooth that overlaps the maxilla by 1 mm at rest, and a ball 40 mm away that does not.
  Case patient = ball_patient();
  patient.parts[0].mesh = box({-30, -90, -40}, {30, -20, 0});
  patient.parts[1].mesh = joined(sphere(5, 5, {15, -30, -47}), box({-5, -88, -60}, {5, -80, -39}));
  const Scene scene = make_scene(std::move(patient));
  // Turned about the tooth, so that only the ball rises.
  const Motion motion{"turn",
                      1,
                      true,
                      [](double t) {
                        Pose pose;
                        pose.R = Eigen::AngleAxisd(0.07 * std::clamp(t, 0.0, 1.0),
                                                   Eigen::Vector3d::UnitX());
                        const Eigen::Vector3d pivot(0, -80, -39);
                        pose.t = pivot - pose.R * pivot;
                        return pose;
                      },
                      {}};
  const auto check = check_clearance(scene, motion, at_120_hz(0), {});
  const auto& pair = check.pairs.at(0);
  EXPECT_NEAR(pair.rest_depth_mm, 1, 1e-6);
  EXPECT_TRUE(pair.worst.sample.was_apart);
  EXPECT_GT(pair.worst.sample.depth_mm, 0.5);
  EXPECT_NEAR(pair.worst.sample.depth_mm, pair.beyond_rest_mm, 1e-9);
  EXPECT_NEAR(check.pairs[0].clearance_mm.back(), -pair.worst.sample.depth_mm, 1e-9);
  EXPECT_NE(worst_caption(pair).find("apart at rest"), std::string::npos);
}

}  // namespace
}  // namespace condyle::test
