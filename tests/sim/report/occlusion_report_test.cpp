#include "sim/report/occlusion_report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "sim/motion/recording.h"
#include "tests/support/program.h"

namespace condyle::test {
namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Two made-up contacts.
OcclusionReport made_up() {
  OcclusionReport report;
  report.patient = "Anna <& Bo>";
  report.start = "the pose of the case";
  auto& bite = report.bite;
  bite.stable = true;
  bite.contacts.resize(2);
  bite.contacts[0] = {26, 36, true, {24, -60, -48}, {0, 0, -1}, 1.5, 0.04, 0.75};
  bite.contacts[1] = {16, 46, false, {-24, -60, -48}, {0, 0, -1}, 0.5, 0.06, 0.25};
  bite.teeth = {{16, 1, 0.5, 0.25}, {26, 1, 1.5, 0.75}, {36, 1, 1.5, 0.75}, {46, 1, 0.5, 0.25}};
  bite.left_fraction = 0.75;
  bite.gap_mm = 0.04;
  bite.condyle_moved = {{{0, -0.8, -0.6}, {0, 0, 0.01}}};
  bite.rest.X_CM.t = {0.1, -0.2, 0.3};
  bite.rest.X_CM.R = Eigen::Quaterniond(0.9998, 0.01, -0.01, 0.005).normalized();
  return report;
}

}  // namespace

TEST(OcclusionReport, ReportsTheSameInJsonTextAndPage) {
  auto report = made_up();
  auto json = nlohmann::json::parse(report.json());
  EXPECT_EQ(json["contacts"].size(), 2u);
  EXPECT_EQ(json["contacts"][0]["upper"], 26);
  EXPECT_EQ(json["teeth"].size(), 4u);
  EXPECT_DOUBLE_EQ(json["load"]["right_share"].get<double>(), 0.25);
  EXPECT_TRUE(contains(report.text(), "2 contacts at 0.1 mm paper, load 75 % left and 25 % right"));
  EXPECT_TRUE(contains(report.text(), "left 0.6 mm down, 0.8 mm forward, right no displacement"));
  const std::string page = report.page();
  EXPECT_TRUE(contains(page, "Stable bite"));
  EXPECT_TRUE(contains(page, "Anna &lt;&amp; Bo&gt;"));
  EXPECT_TRUE(contains(page, "1.00 mm (0.6 mm down, 0.8 mm forward)"));
  EXPECT_TRUE(contains(page, "75 %"));
  EXPECT_FALSE(contains(page, "<script"));

  report.bite.stable = false;
  report.bite.unstable_because = "only the left side bears the load";
  EXPECT_TRUE(contains(report.page(), "No stable bite:</strong> only the left side"));
  EXPECT_TRUE(contains(report.text(), "NO stable bite"));
  EXPECT_EQ(nlohmann::json::parse(report.json())["unstable_because"],
            "only the left side bears the load");
}

TEST(OcclusionReport, MotionLeadsFromTheStartThroughAnOpenMouthToTheBite) {
  const auto report = made_up();
  const Folder folder;
  Pose start;
  start.t = {2, 1, -3};
  write_text(folder / "motion.csv", bite_motion_csv(report.bite, start));
  write_text(folder / "pose.csv", bite_pose_csv(report.bite));
  const Motion motion = read_recording(folder / "motion.csv");
  const Pose& X_CM = report.bite.rest.X_CM;
  EXPECT_EQ(motion.target(0).t, start.t);
  EXPECT_LT((motion.target(motion.duration_s).t - X_CM.t).norm(), 1e-12);
  EXPECT_LT(motion.target(motion.duration_s).R.angularDistance(X_CM.R), 1e-7);
  EXPECT_LT(motion.target(0.5 * motion.duration_s).t.z(), -4);
  EXPECT_EQ(read_recording(folder / "pose.csv").target(0).t, X_CM.t);
}

TEST(OcclusionReport, EmptyBiteHasNoLoadOnEitherSide) {
  OcclusionReport report;
  report.bite.unstable_because = "no tooth touches another";
  const auto json = nlohmann::json::parse(report.json());
  EXPECT_EQ(json["load"]["left_share"], 0);
  EXPECT_EQ(json["load"]["right_share"], 0);
  EXPECT_TRUE(contains(report.page(), "0 contacts; 0 % of the load left, 0 % right"));
}

}  // namespace condyle::test
