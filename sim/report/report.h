#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/motion/joint_fit.h"
#include "sim/report/expression_findings.h"
#include "sim/report/motion_extremes.h"
#include "sim/report/motion_findings.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// Medians and 95th percentiles of stage times, ms.
struct StageSummary {
  double median = 0, p95 = 0;
};
StageSummary summarise(std::vector<double> ms);

/// Collects the results of a motion frame by frame and writes report.json and its summary.
class MotionReport {
 public:
  MotionReport(const Scene& scene, const Motion& motion, const SimulatorSettings& settings);

  void add(const FrameState& frame);

  /// Content of report.json. Also solves the tissue from rest at a few frames, to report how many
  /// iterations the warm start saves.
  std::string json() const;
  /// Summary for the terminal.
  std::string text() const;

  /// The face in the frame with the strongest expression added so far, and that frame's time; empty
  /// without an expression.
  ExpressionMeasures expression() const { return expression_measures(scene_, expressed_); }
  double expression_time_s() const { return expressed_time_s_; }

  /// Measures of the frames added so far: the input of plots and findings.
  const MotionSeries& series() const { return series_; }

 private:
  nlohmann::ordered_json motion_json() const;
  std::vector<Finding> all_findings() const;
  void add_findings(nlohmann::ordered_json& json) const;
  nlohmann::ordered_json contact_json() const;
  nlohmann::ordered_json tissue_json() const;
  std::string contact_text() const;
  std::string tissue_text() const;

  struct PairRecord {
    double min_distance = 1e300, deepest = 0, rest_depth = 0;
    int touching_frames = 0, first_touch = -1, worst_frame = -1, penetrating_frames = 0;
  };

  const Scene& scene_;
  Motion motion_;
  SimulatorSettings settings_;
  MotionSeries series_;
  int frames_ = 0, stopped_frames_ = 0, first_stopped_ = -1;
  int inverted_frames_ = 0, unconverged_frames_ = 0, reused_frames_ = 0;
  double tissue_penetration_mm_ = 0, tissue_slip_mm_ = 0, tissue_contact_error_mm_ = 0;
  double max_rotation_deg_ = 0, left_travel_mm_ = 0, right_travel_mm_ = 0;
  double contact_deviation_mm_ =
      0;  // largest deviation of the incisal point from the prescribed motion, due to contact
  std::vector<PairRecord> pairs_;
  TissueState expressed_;  // of the frame with the strongest expression
  double expressed_time_s_ = 0;
  FrameState widest_;  // frame of largest opening
  int widest_frame_ = 0;
  std::vector<FrameState>
      samples_;  // a few frames spread over the motion, for the solve without warm start
  std::vector<int> iterations_;
  std::map<std::string, std::vector<double>> stage_ms_;
};

}  // namespace condyle
