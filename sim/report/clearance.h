#pragma once

#include <string>
#include <vector>

#include "sim/report/close_look.h"
#include "sim/report/coronoid.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// What one pair of bones did along a motion.
struct PairVerdict {
  std::string a, b;
  bool teeth = false;  // both are teeth: they are meant to meet, so no margin applies
  double rest_distance_mm = 0, rest_depth_mm = 0;
  double least_distance_mm = 0;
  int least_frame = 0;
  double beyond_rest_mm = 0;  // deepest penetration more than at rest
  int deepest_frame = 0;
  int first_touch = -1;  // frame, or -1
  int touching_frames = 0;
  bool violates_margin = false, penetrates = false;

  int touches = 0;                        // times that they came together; at rest counts as one
  std::vector<double> clearance_mm = {};  // one per frame; negative: depth of the overlap
  // Depth at the worst frame; where the pair was apart at rest (away from its overlap there), the
  // depth of that place alone.
  double worst_depth_mm = 0;
  bool worst_was_apart = false;
  Pose X_CM_worst = {};
  PairContact worst = {};  // at worst_frame
  PairDetail detail = {};  // the same, measured closely

  bool violated() const { return violates_margin || penetrates; }
  /// Deepest beyond rest, else nearest, the first if several.
  int worst_frame() const { return beyond_rest_mm > 0 ? deepest_frame : least_frame; }
};

struct ClearanceCheck {
  std::vector<PairVerdict> pairs;
  int frames = 0;
  std::vector<double> opening_mm, rotation_deg;  // one per frame
  std::string pairs_csv;                         // a row per pair and frame

  std::vector<double> time_s;  // one per frame
  std::vector<CoronoidSide> coronoids;
  std::string coronoids_missing;  // why not, when a side or both cannot be told

  bool violated() const;
  /// `pictures`: file of each pair's picture beside the report, or empty; may be shorter.
  std::string json(const Scene& scene, const Motion& motion, double margin_mm,
                   const std::vector<std::string>& pictures = {},
                   const std::vector<std::string>& notes = {}) const;
  std::string text(double margin_mm) const;
};

/// Walks the motion as it is wanted, without stopping at contacts, and tells where bones meet.
ClearanceCheck check_clearance(const Scene& scene, const Motion& motion, double margin_mm,
                               const SimulatorSettings& settings, const Progress& progress = {});

}  // namespace condyle
