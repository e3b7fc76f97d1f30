#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/contact/pair_measure.h"
#include "sim/report/coronoid.h"
#include "sim/report/motion_walk.h"
#include "sim/report/tooth_use.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// When something happens in a motion.
struct MotionTime {
  int frame = 0;         // the first not before it
  bool between = false;  // it lies between that frame and the one before
  double time_s = 0, opening_mm = 0, rotation_deg = 0;
};

/// What one pair of parts did along a motion.
struct PairVerdict {
  std::string a, b;
  PairRule rule;
  double keep_mm = 0;  // clearance that the rule asks for: margin, or gap of a guided pair; else 0

  double rest_distance_mm = 0, rest_depth_mm = 0;
  double least_distance_mm = 0, most_distance_mm = 0;
  MotionTime least_at, most_at;
  double beyond_rest_mm = 0;  // deepest overlap more than at rest
  MotionTime deepest_at;
  std::optional<MotionTime> first_touch;
  int touching_frames = 0;
  int touches = 0;  // times that they came together; at rest counts as one

  // Each breaks the rule:
  bool collides = false;  // the motion makes them touch, or sink deeper than at rest
  bool too_near = false;  // the motion brings them nearer than keep_mm
  bool at_rest = false;   // already at rest they are nearer than keep_mm, or too deep
  bool coincide = false;  // they share much room though neither surface is deep in the other

  /// Deepest beyond rest, else nearest, the first if several.
  struct Worst {
    MotionTime when;
    PairSample sample;
    PairMeasure measure;
    BodyPoses poses;
  } worst;
  // Of a segment or transplant, B, that is too deep in A at rest: moves it out. Not told where open
  // surfaces have no inside.
  std::optional<Eigen::Vector3d> push_out_mm;

  std::vector<double> clearance_mm;  // one per frame; negative: depth of the overlap

  bool violated() const { return collides || too_near || at_rest || coincide; }
};

struct ClearanceCheck {
  std::vector<PairVerdict> pairs;
  double margin_mm = 0;
  std::vector<double> time_s, opening_mm, rotation_deg;  // one per frame
  int looks_between = 0;                                 // moments looked at between frames
  std::string pairs_csv;                                 // a row per pair and frame

  std::vector<CoronoidSide> coronoids;
  std::string coronoids_missing;  // why not, when a side or both cannot be told
  std::vector<ToothUse> teeth;    // of parts with separate crowns

  int frames() const { return static_cast<int>(time_s.size()); }
  /// The first if several.
  std::size_t widest_frame() const;
  bool violated() const;
  /// `pictures`: file of each pair's picture beside the report, or empty; may be shorter.
  std::string json(const Scene& scene, const Motion& motion,
                   const std::vector<std::string>& pictures = {},
                   const std::vector<std::string>& notes = {}) const;
  std::string text() const;
};

struct CheckSettings {
  double margin_mm = 0;  // clearance that forbidden pairs keep, unless their rule has its own
  CheckSampling sampling = {};
};

/// Walks the motion as it is wanted, without stopping at contacts, and tells where bones meet and
/// which rules are broken. Same bits for any number of threads.
ClearanceCheck check_clearance(const Scene& scene, const Motion& motion, const CheckSettings& check,
                               const SimulatorSettings& settings, const Progress& progress = {});

/// Judges the measures of a pair by its rule. `slack_mm`: depth beyond rest that does not count.
void judge(PairVerdict& pair, double slack_mm);

/// "12.3"; what rounds to zero has no sign.
std::string tenths(double value);

/// "must not touch", "may touch, ...", ... for people.
std::string rule_words(const PairVerdict& pair);

/// Which rule was broken and how far, in one sentence; what was kept, where none was.
std::string verdict_words(const PairVerdict& pair);

}  // namespace condyle
