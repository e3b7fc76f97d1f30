#include "sim/report/motion_findings.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "sim/motion/measure_pose.h"
#include "sim/report/motion_plots.h"
#include "sim/report/plots.h"
#include "sim/report/report.h"
#include "tests/sim/motion/jaws.h"
#include "tests/support/boxes.h"
#include "tests/support/builtin.h"
#include "tests/support/scanned_open.h"

namespace condyle::test {
namespace {

/// A jaw that moves to a pose and back in a second.
Motion there_and_back(const std::function<Pose(double fraction)>& pose, std::string phase = "") {
  Motion motion{"found",
                1.0,
                false,
                [pose](double t) { return pose(0.5 - 0.5 * std::cos(2 * std::numbers::pi * t)); },
                {}};
  if (!phase.empty()) motion.phases = {{phase, 0, 1}};
  return motion;
}

MotionSeries series_of(const Scene& scene, const Motion& motion, int frames = 201) {
  MotionSeries series(scene, motion);
  FrameState frame = rest_frame(scene);
  for (int i = 0; i < frames; ++i) {
    frame.time_s = motion.duration_s * i / (frames - 1);
    frame.poses = motion.target(frame.time_s);
    frame.measures = measure(scene.patient, frame.poses);
    if (motion.muscles) frame.muscles = motion.muscles(frame.time_s);
    series.add(frame);
  }
  return series;
}

}  // namespace

TEST(FrontalArea, IsThatOfThePolygonProjectedToTheFront) {
  EXPECT_NEAR(frontal_area({{0, 5, 0}, {4, -9, 0}, {4, 0, 3}, {0, 2, 3}}), 12, 1e-12);
  EXPECT_NEAR(frontal_area({{0, 0, 3}, {4, 0, 3}, {4, 0, 0}, {0, 0, 0}}), 12, 1e-12);
  EXPECT_EQ(frontal_area({}), 0);
}

TEST(Findings, OfAPatientScannedWithTheMouthOpenCountFromTheClosedPosition) {
  SimulatorSettings settings;
  settings.tissue = false;
  const Scene scene = make_scene(scanned_open(builtin(), 5), settings);
  const Motion motion = make_motion("opening", scene.patient, scene.contacts);
  for (const Finding& one : findings(scene, motion, series_of(scene, motion)))
    if (one.name == "maximum opening") {
      EXPECT_NEAR(one.value, 51.2, 0.5);
      return;
    }
  ADD_FAILURE() << "no maximum opening";
}

TEST(Findings, DistinguishInputsFromEmergentQuantities) {
  const Scene scene = make_scene(box_patient());
  const auto down = [](double fraction) {
    return Pose{Eigen::Quaterniond::Identity(), {0, 0, -45 * fraction}};
  };
  Motion motion = there_and_back(down, "opening");
  const auto found = findings(scene, motion, series_of(scene, motion));
  motion.recorded = true;
  const auto recorded = findings(scene, motion, series_of(scene, motion));
  const auto named = [](const std::vector<Finding>& all, const std::string& name) {
    for (const auto& finding : all)
      if (finding.name == name) return finding;
    ADD_FAILURE() << name;
    return Finding{};
  };
  EXPECT_TRUE(named(found, "maximum opening").input);
  EXPECT_FALSE(named(recorded, "maximum opening").input);
  EXPECT_NEAR(named(found, "maximum opening").value, 45, 1e-9);
  // A jaw that sinks without turning is no living jaw's.
  const Finding turned = named(found, "rotation at maximum opening");
  EXPECT_FALSE(turned.input);
  EXPECT_FALSE(turned.within());
  EXPECT_FALSE(turned.why.empty());
  EXPECT_FALSE(named(found, "left condylar travel at maximum opening").within());
}

/// Name and whether it is an input of each finding.
std::map<std::string, bool> inputs_of(const Scene& scene, const Motion& motion) {
  std::map<std::string, bool> inputs;
  for (const auto& finding : findings(scene, motion, series_of(scene, motion)))
    inputs[finding.name] = finding.input;
  return inputs;
}

TEST(Findings, AreEmergentOnlyWhereAnotherAnatomyWouldChangeThem) {
  SimulatorSettings bones;
  bones.tissue = false;
  const Scene fossae = make_scene(jaw_in_fossae(), bones), average = make_scene(free_jaw(), bones);
  Motion motion = there_and_back([](double fraction) {
    return Pose{Eigen::Quaterniond::Identity(), {0, -8 * fraction, -45 * fraction}};
  });
  const std::string deviation = "midline deviation at maximum opening",
                    left = "left condylar inclination over 5 mm",
                    right = "right condylar inclination over 5 mm",
                    gap = "left condyle to fossa, minimum";
  auto of_fossae = inputs_of(fossae, motion);
  EXPECT_FALSE(of_fossae.at(deviation));
  EXPECT_FALSE(of_fossae.at(left));
  EXPECT_TRUE(of_fossae.at(gap));  // the disc gap, which guides the condyle
  auto on_average = inputs_of(average, motion);
  EXPECT_TRUE(on_average.at(deviation));  // the same path on both sides
  EXPECT_TRUE(on_average.at(left));
  motion.inputs = {{"inclination_left", "deg", 40}};
  of_fossae = inputs_of(fossae, motion);
  EXPECT_TRUE(of_fossae.at(deviation));
  EXPECT_TRUE(of_fossae.at(left));
  EXPECT_FALSE(of_fossae.at(right));
  motion.recorded = true;  // nothing was prescribed
  for (const auto& [name, input] : inputs_of(average, motion)) EXPECT_FALSE(input) << name;
}

TEST(Findings, OfFewFramesLeaveOutTheLengthOfTheCondylarPath) {
  const Scene scene = make_scene(box_patient());
  const Motion motion = there_and_back([](double fraction) {
    return Pose{Eigen::Quaterniond::Identity(), {0, 0, -45 * fraction}};
  });
  const auto has_curve = [&](int frames) {
    const auto all = findings(scene, motion, series_of(scene, motion, frames));
    EXPECT_FALSE(all.empty());
    return std::any_of(all.begin(), all.end(), [](const Finding& finding) {
      return finding.name == "left condylar travel along its curve";
    });
  };
  EXPECT_TRUE(has_curve(201));
  EXPECT_FALSE(has_curve(11));
}

TEST(Warnings, NameWhatNoJawCanDoAndAreAbsentOtherwise) {
  const Scene scene = make_scene(box_patient());
  const auto by = [&](const Eigen::Vector3d& displacement) {
    const Motion motion = there_and_back([displacement](double fraction) {
      return Pose{Eigen::Quaterniond::Identity(), displacement * fraction};
    });
    return physiology_warnings(series_of(scene, motion));
  };
  EXPECT_TRUE(by({0, -5, -5}).empty());
  const auto expect_warning = [](const std::vector<std::string>& warnings,
                                 const std::string& word) {
    for (const auto& warning : warnings)
      if (warning.find(word) != std::string::npos) return;
    ADD_FAILURE() << word;
  };
  expect_warning(by({0, 0, -40000}), "opening of 40000.0 mm");  // metres read as millimetres
  expect_warning(by({0, 0, 30}), "above");
  expect_warning(by({20, 0, 0}), "to the left");
  expect_warning(by({-20, 0, 0}), "to the right");
  expect_warning(by({0, 8, 0}), "behind its rest position");
  expect_warning(by({0, -18, 0}), "protrusion");
  expect_warning(by({0, -15, -20}), "the left condyle travels 25.0 mm");
  expect_warning(by({0, -15, -20}), "the right condyle travels 25.0 mm");
  const auto turned = [&](double degrees, const Eigen::Vector3d& axis,
                          const Eigen::Vector3d& displacement) {
    const Motion motion = there_and_back([=](double fraction) {
      const double angle = fraction * degrees * std::numbers::pi / 180;
      return Pose{Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), displacement * fraction};
    });
    return physiology_warnings(series_of(scene, motion));
  };
  expect_warning(turned(55, Eigen::Vector3d::UnitX(), {0, 0, 0}), "the jaw rotates by 55.0 deg");
  const auto fast = [&](double displacement) {  // there in a twentieth of a second
    Motion motion = there_and_back([displacement](double fraction) {
      return Pose{Eigen::Quaterniond::Identity(), {0, 0, -displacement * fraction}};
    });
    motion.duration_s = 0.1;
    motion.target = [slow = motion.target](double t) { return slow(10 * t); };
    return physiology_warnings(series_of(scene, motion));
  };
  expect_warning(fast(40), "the incisors open at");
  expect_warning(fast(40), "the incisors close at");
  const auto opened = [&](double displacement) {
    const Motion motion = there_and_back(
        [displacement](double fraction) {
          return Pose{Eigen::Quaterniond::Identity(), {0, 0, -displacement * fraction}};
        },
        "opening");
    return physiology_warnings(series_of(scene, motion));
  };
  expect_warning(opened(20), "counts as limited");
  for (const std::string& warning : opened(29.97))  // 30.0 mm, as printed
    EXPECT_EQ(warning.find("counts as limited"), std::string::npos) << warning;
}

TEST(Warnings, ReportUnequalCondylarTravelInAStraightOpening) {
  const Scene scene = make_scene(box_patient());
  const Eigen::Vector3d incisor = *scene.patient.landmarks.find("lower_incisal_point");
  MotionSeries series(scene, there_and_back([](double) { return Pose{}; }));
  const auto by = [&](double difference_mm) {
    FrameState frame = rest_frame(scene);
    frame.measures.opening_mm = 30;
    frame.measures.incisor = incisor - Eigen::Vector3d(0, 0, 30);
    frame.measures.left_condyle_travel_mm = 12 + difference_mm;
    frame.measures.right_condyle_travel_mm = 12;
    MotionSeries one = series;
    one.add(frame);
    return physiology_warnings(one);
  };
  EXPECT_TRUE(by(3).empty());
  ASSERT_EQ(by(5).size(), 1u);
  EXPECT_NE(by(5)[0].find("travel differs by 5.0 mm"), std::string::npos);
}

TEST(Report, PrintsFindingsWithTheirBands) {
  const Scene scene = make_scene(box_patient());
  const Motion motion = there_and_back(
      [](double fraction) {
        return Pose{Eigen::Quaterniond::Identity(), {0, 0, -45 * fraction}};
      },
      "opening");
  MotionReport report(scene, motion, {});
  FrameState frame = rest_frame(scene);
  for (int i = 0; i <= 60; ++i) {
    frame.time_s = i / 60.0;
    frame.poses = motion.target(frame.time_s);
    frame.measures = measure(scene.patient, frame.poses);
    if (motion.muscles) frame.muscles = motion.muscles(frame.time_s);
    report.add(frame);
  }
  const auto json = nlohmann::json::parse(report.json());
  EXPECT_EQ(json["motion"]["phases"][0]["name"], "opening");
  ASSERT_FALSE(json["findings"].empty());
  for (const auto& finding : json["findings"]) {
    EXPECT_TRUE(finding["value"].is_number());
    EXPECT_TRUE(finding["emergent"].is_boolean());
    if (finding.contains("within") && !finding["within"].get<bool>()) {
      EXPECT_FALSE(finding["why"].get<std::string>().empty());
    }
  }
  EXPECT_FALSE(json["outside_bands"].empty());
  EXPECT_NE(report.text().find("emergent"), std::string::npos);
  EXPECT_NE(report.text().find("2 more follow from the inputs"), std::string::npos)
      << report.text();  // maximum opening, midline deviation
}

TEST(Report, ListsAPrescribedQuantityOutsideItsRange) {
  const Scene scene = make_scene(box_patient());
  const Motion motion = there_and_back([](double fraction) {
    return Pose{Eigen::Quaterniond::Identity(), {0, 0, -62 * fraction}};
  });
  MotionReport report(scene, motion, {});
  FrameState frame = rest_frame(scene);
  for (int i = 0; i <= 60; ++i) {
    frame.time_s = i / 60.0;
    frame.poses = motion.target(frame.time_s);
    frame.measures = measure(scene.patient, frame.poses);
    report.add(frame);
  }
  const std::string words = "maximum opening (prescribed): 62.00 mm, reference range 42 to 58";
  EXPECT_NE(report.text().find(words), std::string::npos) << report.text();
  const auto json = nlohmann::json::parse(report.json());
  EXPECT_NE(json["outside_bands"].dump().find(words), std::string::npos);
}

TEST(Report, SaysThatNothingMovesWithoutAMandibleAndFindsNothing) {
  Case patient = box_patient();
  std::erase_if(patient.parts, [](const Part& part) { return part.body == mandible_body; });
  SimulatorSettings bones;
  bones.tissue = false;
  const Scene scene = make_scene(patient, bones);
  const Motion motion = make_motion("opening", scene.patient, scene.contacts);
  ASSERT_FALSE(motion.notes.empty());
  EXPECT_NE(motion.notes[0].find("moves with the mandible"), std::string::npos) << motion.notes[0];
  Playback playback(scene, motion, bones);
  MotionReport report(scene, motion, bones);
  for (int i = 0; i <= 30; ++i) report.add(playback.at(motion.duration_s * i / 30));
  EXPECT_TRUE(nlohmann::json::parse(report.json())["findings"].empty());
  EXPECT_EQ(report.text().find("emergent"), std::string::npos) << report.text();
}

/// No curve of the drawing crosses the name of a band or level. Returns how many names there are.
int expect_names_clear(const std::string& svg, const std::string& title) {
  std::vector<Eigen::Vector2d> points;
  for (std::size_t at = 0; (at = svg.find("<polyline", at)) != std::string::npos; ++at) {
    std::istringstream in(svg.substr(svg.find("points=\"", at) + 8));
    Eigen::Vector2d last(0, 0), next(0, 0);
    char comma = 0;
    for (bool first = true; in >> next.x() >> comma >> next.y(); last = next, first = false)
      for (int k = 0; k <= 20; ++k)
        if (!first || k == 20)
          points.push_back(next + (first ? 0.0 : (20 - k) / 20.0) * (last - next));
  }
  EXPECT_GT(points.size(), 100u) << title;
  int names = 0;
  for (std::size_t at = 0; (at = svg.find("<text class=\"name\"", at)) != std::string::npos; ++at) {
    const auto number = [&](const char* key) {
      return std::stod(svg.substr(svg.find(key, at) + std::string(key).size()));
    };
    const double x = number(" x=\""), y = number(" y=\""), size = number("font-size=\"");
    const std::size_t from = svg.find('>', at) + 1;
    const double wide = 0.55 * size * static_cast<double>(svg.find('<', from) - from);
    for (const auto& p : points)
      EXPECT_FALSE(p.x() > x && p.x() < x + wide && p.y() > y - 0.8 * size && p.y() < y)
          << title << ": " << svg.substr(from, svg.find('<', from) - from);
    ++names;
  }
  return names;
}

TEST(MotionPlots, HaveAxesUnitsAndBandsAndKeepAllPointsInside) {
  const Scene scene = make_scene(box_patient());
  Motion motion = there_and_back(
      [](double fraction) {
        return Pose{Eigen::Quaterniond::Identity(), {9 * fraction, -8 * fraction, -45 * fraction}};
      },
      "chewing left");
  motion.borders.frontal = {{0, -90, -50}, {9, -90, -55}, {0, -80, -95}, {-9, -90, -55}};
  const auto plots = motion_plots(series_of(scene, motion));
  ASSERT_EQ(plots.size(), 4u);
  int names = 0;
  for (const auto& plot : plots) {
    EXPECT_GE(plot.panels.size(), 2u);
    bool banded = false;
    for (const auto& panel : plot.panels) {
      EXPECT_FALSE(panel.settings.x_label.empty());
      const auto& unit = panel.settings.y_label;
      EXPECT_TRUE(unit.find("mm") != std::string::npos || unit.find("\u00b0") != std::string::npos);
      banded |= !panel.settings.bands.empty();
    }
    EXPECT_TRUE(banded) << plot.name;
    const std::string svg = panels_svg(plot.panels);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    for (const auto& panel : plot.panels)
      names += expect_names_clear(plot_svg(panel.curves, panel.settings), panel.settings.title);
    std::size_t opened = 0, closed = 0;
    for (std::size_t at = 0; (at = svg.find("<svg ", at)) != std::string::npos; ++at) ++opened;
    for (std::size_t at = 0; (at = svg.find("</svg>", at)) != std::string::npos; ++at) ++closed;
    EXPECT_EQ(opened, plot.panels.size() + 1);
    EXPECT_EQ(opened, closed);
  }
  EXPECT_GT(names, 8);
}

TEST(MotionPlots, ShowWhatTheMusclesOfEachSideDo) {
  const Scene scene = make_scene(box_patient());
  Motion motion = there_and_back(
      [](double fraction) {
        return Pose{Eigen::Quaterniond::Identity(), {0, 0, -20 * fraction}};
      },
      "opening");
  motion.muscle_names = {"lat", "rat", "lad", "rad", "ta"};
  motion.muscles = [](double time_s) {
    MuscleStates states(5);
    states[1].activation = 0.5 * std::min(time_s, 1.0);
    states[1].force_N = 80;
    states[3].activation = 0.001;  // too little to be drawn
    return states;
  };
  const auto plots = motion_plots(series_of(scene, motion));
  ASSERT_EQ(plots.size(), 6u);
  const auto& activity = plots[4].panels;
  ASSERT_EQ(activity.size(), 3u);  // left, right, and the one without a twin
  EXPECT_EQ(activity[0].curves[0].name, "none");
  ASSERT_EQ(activity[1].curves.size(), 1u);
  EXPECT_EQ(activity[1].curves[0].name, "rat");
  EXPECT_NEAR(*std::max_element(activity[1].curves[0].y.begin(), activity[1].curves[0].y.end()),
              0.5, 0.01);
  EXPECT_EQ(plots[5].panels[1].settings.y_label, "N");
}

}  // namespace condyle::test
