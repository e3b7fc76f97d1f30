#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/motion/joint_fit.h"
#include "sim/report/motion_extremes.h"
#include "sim/report/motion_truth.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// Medians and 95th percentiles of stage times, ms.
struct StageSummary {
  double median = 0, p95 = 0;
};
StageSummary summarise(std::vector<double> ms);

/// Gathers what a motion did, frame by frame, and tells it as JSON: the content of report.json.
class MotionReport {
 public:
  MotionReport(const Scene& scene, const Motion& motion, const SimulatorSettings& settings);

  void add(const FrameState& frame);

  /// Also solves the tissue cold at a few of the frames seen, to tell what the warm start saves.
  std::string json() const;
  /// A few sentences for people.
  std::string text() const;

  /// The frames' measures so far: what plots and findings are made from.
  const MotionSeries& series() const { return series_; }

 private:
  struct PairRecord {
    double least_distance = 1e300, deepest = 0, rest_depth = 0;
    int touching_frames = 0, first_touch = -1, worst_frame = -1, penetrating_frames = 0;
  };

  const Scene& scene_;
  Motion motion_;
  SimulatorSettings settings_;
  MotionSeries series_;
  int frames_ = 0, stopped_frames_ = 0, first_stopped_ = -1;
  int inverted_frames_ = 0, unconverged_frames_ = 0, kept_frames_ = 0;
  double tissue_penetration_mm_ = 0, tissue_slip_mm_ = 0, tissue_contact_error_mm_ = 0;
  double max_rotation_deg_ = 0, left_travel_mm_ = 0, right_travel_mm_ = 0;
  double kept_back_mm_ = 0;  // of the incisal point from where it was wanted, by contact
  std::vector<PairRecord> pairs_;
  FrameState widest_;  // frame of largest opening
  int widest_frame_ = 0;
  std::vector<FrameState> samples_;  // a few frames spread over the opening, for the cold solve
  std::vector<int> iterations_;
  std::map<std::string, std::vector<double>> stage_ms_;
};

}  // namespace condyle
