#include "sim/report/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sim/report/clearance.h"
#include "sim/report/plots.h"
#include "sim/report/trace.h"
#include "tests/sim/report/lift.h"
#include "tests/support/boxes.h"
#include "tests/support/program.h"

namespace condyle::test {
namespace {}  // namespace

TEST(Trace, HasTheColumnsOfTheContractAndAnEarlierTraceStaysUntilFinish) {
  const Folder folder;
  const auto file = folder.path() / "trace.csv";
  write_text(file, "earlier");
  {
    TraceWriter dropped(file);
    dropped.add(0, {});
    EXPECT_EQ(read_text(file), "earlier");
  }
  EXPECT_EQ(read_text(file), "earlier");
  TraceWriter trace(file);
  FrameState frame;
  frame.poses = Pose{Eigen::Quaterniond::Identity(), {1.0 / 3, 0, 0}};
  trace.add(0, frame);
  trace.finish();
  std::istringstream text(read_text(file));
  std::string header, row;
  std::getline(text, header);
  std::getline(text, row);
  EXPECT_TRUE(header.starts_with("frame,time_s,tx_mm,ty_mm,tz_mm,qw,qx,qy,qz,incisor_x_mm,"));
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(row.begin(), row.end(), ','));
  EXPECT_TRUE(row.starts_with("0,0,0.3333333333333333,0,0,1,")) << row;
}

TEST(Trace, SaysWhetherTheTissueWasKeptBecauseItsSolveFailed) {
  const Folder folder;
  const auto file = folder.path() / "trace.csv";
  TraceWriter trace(file);
  FrameState good, failed;
  failed.tissue.reused = true;
  failed.tissue.converged = false;
  failed.tissue.energy = std::nan("");
  trace.add(0, good);
  trace.add(1, failed);
  trace.finish();
  const std::string text = read_text(file);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  std::istringstream lines(text);
  const auto cells = [&] {
    std::string line, cell;
    std::getline(lines, line);
    std::istringstream row(line);
    std::vector<std::string> all;
    while (std::getline(row, cell, ',')) all.push_back(cell);
    return all;
  };
  const auto names = cells();
  for (const char* expected : {"0", "1"}) {
    const auto row = cells();
    const auto value = [&](const char* name) {
      return row.at(
          static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin()));
    };
    EXPECT_EQ(value("tissue_kept"), expected);
    EXPECT_NE(value("tissue_converged"), expected);
  }
}

TEST(Clearance, MarginAndPenetrationAreDistinguished) {
  const Scene scene = make_scene(box_patient());
  const auto verdict = [&](double height, double margin) {
    return check_clearance(scene, lift(height), {.margin_mm = margin, .sampling = {7, 0}}, {})
        .pairs.at(0);
  };
  EXPECT_NEAR(verdict(0.4, 0).min_distance_mm, 0.6, 1e-9);
  EXPECT_FALSE(verdict(0.4, 0.5).violated());
  EXPECT_TRUE(verdict(0.6, 0.5).too_close);
  EXPECT_FALSE(verdict(0.6, 0.5).collides);
  const auto deep = verdict(3, 0);
  EXPECT_TRUE(deep.collides);
  EXPECT_NEAR(deep.beyond_rest_mm, 2.0, 1e-6);
  EXPECT_NEAR(deep.first_touch->time_s, 1.0 / 6, 0.02 / 6);  // 1 mm of the 6 mm/s
}

TEST(Report, CountsEventsOfTheFrames) {
  const Scene scene = make_scene(box_patient());
  Playback playback(scene, lift(3), {});
  MotionReport report(scene, playback.motion(), {});
  for (int i = 0; i <= 60; ++i) report.add(playback.at(i / 120.0));
  const auto json = nlohmann::json::parse(report.json());
  EXPECT_EQ(json["frames"], 61);
  const auto& pair = json["contact"]["pairs"][0];
  EXPECT_NEAR(pair["beyond_rest_mm"].get<double>(), 2.0, 1e-6);
  EXPECT_EQ(pair["overlap_at_rest_mm"], 0.0);
  EXPECT_NEAR(pair["penetrating_frames"].get<int>(), 40, 2);
}

TEST(Summary, MedianAndPercentile) {
  std::vector<double> ms;
  for (int i = 100; i >= 1; --i) ms.push_back(i);
  EXPECT_EQ(summarise(ms).median, 50);
  EXPECT_EQ(summarise(ms).p95, 95);
  EXPECT_EQ(summarise({}).median, 0);
}

TEST(Plot, CurvesLieWithinTheAxes) {
  const auto svg =
      plot_svg({{"a", {0, 1, 2}, {-5, 50, 3}}}, {.title = "t", .x_label = "x", .y_label = "y"});
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
  std::istringstream points(svg.substr(svg.find("points=\"") + 8));
  double x = 0, y = 0;
  char comma = 0;
  int count = 0;
  while (points >> x >> comma >> y) {
    EXPECT_GE(x, 70);
    EXPECT_LE(x, 620);
    EXPECT_GE(y, 44);
    EXPECT_LE(y, 424);
    ++count;
  }
  EXPECT_EQ(count, 3);
}

TEST(Plot, ACurveThatLiesOnAnotherHidesNeither) {
  const auto widths = [](std::vector<double> second) {
    const auto svg = plot_svg({{"left", {0, 1, 2}, {0, 5, 9}}, {"right", {0, 1, 2}, second}},
                              {.title = "t", .x_label = "x", .y_label = "y", .legend = false});
    std::vector<double> found;
    for (auto at = svg.find("<polyline"); at != std::string::npos; at = svg.find("<polyline", at)) {
      at = svg.find("stroke-width=\"", at) + 14;
      found.push_back(std::stod(svg.substr(at)));
    }
    return found;
  };
  EXPECT_EQ(widths({0, 5, 3}), (std::vector<double>{5, 2})) << "the lower one is seen beside";
  EXPECT_EQ(widths({1, 5, 3}), (std::vector<double>{2, 2}));
}

}  // namespace condyle::test
