#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "sim/report/check_page.h"
#include "sim/report/clearance.h"
#include "tests/sim/report/lift.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle::test {
namespace {

/// A ball 1 mm below a plate, or as far in it when `gap_mm` is negative.
Case ball_below(double gap_mm = 1) {
  Case patient = box_patient();
  patient.parts[1].mesh = sphere(4, 10, {15, -65, -50 - gap_mm});
  return patient;
}

PairVerdict verdict(const PairRule& rule, double height_mm, double margin_mm = 0,
                    double gap_mm = 1) {
  SimulatorSettings settings;
  settings.contact.pair_rules = {rule};
  settings.tissue = false;
  const Scene scene = make_scene(ball_below(gap_mm), settings);
  return check_clearance(scene, lift(height_mm),
                         {.margin_mm = margin_mm, .sampling = {.frames = 6}}, settings)
      .pairs.at(0);
}

std::string breaks(const PairVerdict& pair) {
  return std::string(pair.collides ? "collides " : "") + (pair.too_close ? "too close " : "") +
         (pair.at_rest ? "at rest " : "");
}

bool says(const PairVerdict& pair, const char* words) {
  return verdict_text(pair).find(words) != std::string::npos;
}

TEST(PairRules, ForbiddenKeepsItsOwnMarginOtherwiseTheRequestedOne) {
  const PairRule plain{"*", "*", PairPolicy::forbidden, std::nullopt, 0};
  PairRule own = plain;
  own.margin_mm = 0.5;
  EXPECT_EQ(breaks(verdict(plain, 0.4, 0.5)), "");
  EXPECT_EQ(breaks(verdict(plain, 0.6, 0.5)), "too close ");
  EXPECT_EQ(breaks(verdict(plain, 1.2, 0.5)), "collides too close ");
  EXPECT_EQ(breaks(verdict(own, 0.4, 0.9)), "");
  EXPECT_EQ(breaks(verdict(own, 0.6, 0)), "too close ");
}

TEST(PairRules, TooNearAtRestIsDistinguishedFromTooNearInMotion) {
  const PairRule rule{"*", "*", PairPolicy::forbidden, std::nullopt, 0};
  const auto away = verdict(rule, -3, 2);
  EXPECT_EQ(breaks(away), "at rest ");
  EXPECT_TRUE(says(away, "closer than the margin of 2.00 mm at rest (1.00 mm)"));
  EXPECT_TRUE(says(away, "does not make it worse"));
  const auto nearer = verdict(rule, 0.5, 2);
  EXPECT_EQ(breaks(nearer), "at rest ");
  EXPECT_TRUE(says(nearer, "brings them to 0.50 mm"));
  EXPECT_EQ(breaks(verdict(rule, 1.5, 2)), "collides at rest ");
  const auto overlapping = verdict(rule, -3, 2, -0.3);
  EXPECT_EQ(breaks(overlapping), "at rest ");
  EXPECT_TRUE(says(overlapping, "overlap at rest (0.30 mm)"));
  // Without a margin the overlap at rest is the baseline.
  EXPECT_EQ(breaks(verdict(rule, -3, 0, -0.3)), "");
  EXPECT_EQ(breaks(verdict(rule, 0.2, 0, -0.3)), "collides ");
}

TEST(PairRules, AllowedMayTouchButNotOverlapMoreThanAtRest) {
  const PairRule rule{"maxilla", "mandible", PairPolicy::allowed, std::nullopt, 0};
  EXPECT_EQ(breaks(verdict(rule, 1.01, 3)), "");
  EXPECT_TRUE(verdict(rule, 1.01, 3).first_touch.has_value());
  EXPECT_EQ(breaks(verdict(rule, 1.5)), "collides ");
  EXPECT_EQ(breaks(verdict(rule, -1, 3, -0.3)), "");
}

TEST(PairRules, GuidedKeepsItsGapAndReportsItsRange) {
  const PairRule rule{"mandible", "maxilla", PairPolicy::guided, std::nullopt, 0.3};
  const auto kept = verdict(rule, 0.5, 5);
  EXPECT_EQ(breaks(kept), "");
  EXPECT_NEAR(kept.min_distance_mm, 0.5, 1e-6);
  EXPECT_NEAR(kept.max_distance_mm, 1, 1e-6);
  EXPECT_NEAR(kept.min_distance_at.time_s, 0.5, 1e-9);
  EXPECT_EQ(kept.max_distance_at.time_s, 0);
  EXPECT_TRUE(says(kept, "gap of 0.50 mm"));
  EXPECT_EQ(breaks(verdict(rule, 0.8)), "too close ");
  EXPECT_EQ(breaks(verdict(rule, 1.2)), "collides too close ");
  EXPECT_EQ(breaks(verdict({"*", "*", PairPolicy::guided, std::nullopt, 1.5}, 0)), "at rest ");
}

TEST(PairRules, CutFacesMayLieOnEachOtherButNotSinkIn) {
  const PairRule rule{"*", "*", PairPolicy::cut_face, std::nullopt, 0};
  EXPECT_EQ(breaks(verdict(rule, 1.08, 5)), "");
  EXPECT_EQ(breaks(verdict(rule, 1.15)), "collides ");
  EXPECT_EQ(breaks(verdict(rule, -1, 0, -0.05)), "");
  EXPECT_EQ(breaks(verdict(rule, -1, 0, -0.3)), "at rest ");
}

TEST(PairRules, CoincidentCopiesAreNotReportedAsContact) {
  // No point of either is deep in the other.
  for (const double aside : {0.0, 0.05}) {
    Case patient = ball_below();
    const auto graft = [&](const char* name, double x) {
      patient.add_piece({name, Role::transplant, box({x, -70, -56}, {x + 10, -60, -46}), {}},
                        cranium_body);
    };
    graft("graft", -20);
    graft("graft-2", -20 + aside);
    const Scene scene = make_scene(patient);
    const auto check = check_clearance(scene, lift(0.1), {.sampling = {.frames = 2}}, {});
    int found = 0;
    for (const auto& pair : check.pairs) {
      if (pair.a != "graft" || pair.b != "graft-2") continue;
      ++found;
      EXPECT_TRUE(pair.coincide);
      EXPECT_TRUE(pair.violated());
      EXPECT_NE(verdict_text(pair).find("in common"), std::string::npos) << verdict_text(pair);
    }
    EXPECT_EQ(found, 1);
  }
}

TEST(PairRules, SegmentsAndTransplantsAreCheckedWithAllOtherBodies) {
  Case patient = ball_below();
  Part segment{"graft", Role::transplant, box({-20, -70, -46}, {-10, -60, -40.5}), {}};
  patient.add_piece(segment, mandible_body);
  const Scene scene = make_scene(patient);
  const auto check = check_clearance(scene, lift(0.8), {.sampling = {.frames = 4}}, {});
  ASSERT_EQ(check.pairs.size(), 3u);
  int found = 0;
  for (const auto& pair : check.pairs) {
    if (pair.b != "graft") continue;
    ++found;
    EXPECT_EQ(pair.rule.policy,
              pair.a == "mandible" ? PairPolicy::cut_face : PairPolicy::forbidden);
    // It moves with the mandible: 0.5 mm below the maxilla, lifted by 0.8 mm.
    EXPECT_EQ(pair.collides, pair.a == "maxilla");
    EXPECT_NEAR(pair.worst.sample.depth_mm, pair.a == "maxilla" ? 0.3 : 0, 1e-6);
    EXPECT_EQ(pair.worst.measure.region_b, "graft");
  }
  EXPECT_EQ(found, 2);
}

TEST(PairsTable, HasARowForEachPairAndFrameAndTheReportsNumbers) {
  SimulatorSettings settings;
  settings.tissue = false;
  Case patient = ball_below(-0.2);
  patient.parts[1].name = "jaw, \"lower\"";
  const Scene scene = make_scene(std::move(patient), settings);
  const auto motion = lift(1);
  const auto check = check_clearance(scene, motion, {.sampling = {.frames = 5}}, settings);
  const auto& pair = check.pairs.at(0);
  std::istringstream text(check.pairs_csv);
  std::string header, row;
  std::getline(text, header);
  int rows = 0;
  for (; std::getline(text, row); ++rows)
    EXPECT_NE(row.find("\"jaw, \"\"lower\"\"\""), std::string::npos);
  EXPECT_EQ(rows, 5);
  // The last frame is the worst one: 1.2 mm deep, 1 mm deeper than at rest.
  EXPECT_FALSE(pair.worst.when.between);
  EXPECT_EQ(pair.worst.when.frame, 4);
  const auto json = nlohmann::json::parse(check.json(scene, motion));
  const auto& worst = json["pairs"][0]["worst"];
  EXPECT_NEAR(worst["depth_mm"].get<double>(), 1.2, 1e-3);
  EXPECT_NEAR(json["pairs"][0]["beyond_rest_mm"].get<double>(), 1, 1e-3);
  const auto last = check.pairs_csv.rfind("\n4,");
  EXPECT_NE(check.pairs_csv.find("," + worst["depth_mm"].dump() + ",", last), std::string::npos);
  EXPECT_NE(check.pairs_csv.find("," + worst["penetration_volume_mm3"].dump() + ",", last),
            std::string::npos);
}

TEST(ToothUse, CountsFramesAndTimesOfEachTooth) {
  Case patient = box_patient();
  patient.parts[0] = {"upper", Role::upper_teeth, box({-30, -70, -40}, {30, -60, -30}), {}};
  // The left molar is 1 mm below its antagonists, the right one 2 mm.
  patient.parts[1] = {
      "lower",
      Role::lower_teeth,
      joined(box({15, -70, -50}, {25, -60, -41}), box({-25, -70, -50}, {-15, -60, -42})),
      {{36, 0, 12}, {46, 12, 12}}};
  const Scene scene = make_scene(std::move(patient));
  // Twice up by 4 mm and down again: above 1 mm for three quarters of the time, 2 mm for half.
  const Motion motion{"chew",
                      1,
                      true,
                      [](double t) {
                        Pose pose;
                        pose.t = {0, 0, 2 - 2 * std::cos(4 * std::numbers::pi * t)};
                        return pose;
                      },
                      {}};
  const auto check = check_clearance(scene, motion, {.sampling = {.frames = 121}}, {});
  ASSERT_EQ(check.teeth.size(), 2u);
  EXPECT_EQ(check.teeth[0].fdi, 36);
  EXPECT_EQ(check.teeth[0].touches, 2);
  EXPECT_NEAR(check.teeth[0].touching_frames / 121.0, 2.0 / 3, 0.02);
  EXPECT_EQ(check.teeth[1].touches, 2);
  EXPECT_NEAR(check.teeth[1].touching_frames / 121.0, 0.5, 0.02);
  EXPECT_EQ(check.pairs.at(0).touches, 2);
  const auto chart = teeth_svg(check);
  EXPECT_NE(chart.find(">36<"), std::string::npos);
  const long percent = std::lround(100.0 * check.teeth[0].touching_frames / 121);
  EXPECT_NE(chart.find(">" + std::to_string(percent) + " %<"), std::string::npos);
}

}  // namespace
}  // namespace condyle::test
