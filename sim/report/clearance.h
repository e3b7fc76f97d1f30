#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/contact/pair_measure.h"
#include "sim/report/coronoid.h"
#include "sim/report/motion_sampler.h"
#include "sim/report/tooth_use.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// The time of an event in a motion.
struct MotionTime {
  int frame = 0;         // the first frame at or after the event
  bool between = false;  // the event lies between that frame and the previous one
  double time_s = 0, opening_mm = 0, rotation_deg = 0;
};

/// Clearance and contact of one pair of parts during a motion, and the verdict on its rule.
struct PairVerdict {
  std::string a, b;
  PairRule rule;
  double required_mm =
      0;  // clearance required by the rule: margin, or gap of a guided pair; else 0

  double rest_distance_mm = 0, rest_depth_mm = 0;
  double min_distance_mm = 0, max_distance_mm = 0;
  MotionTime min_distance_at, max_distance_at;
  double beyond_rest_mm = 0;  // largest depth in excess of that at rest
  MotionTime deepest_at;
  std::optional<MotionTime> first_touch;
  int touching_frames = 0;
  int touches = 0;  // number of times they came into contact; contact at rest counts

  // Each of these breaks the rule:
  bool collides = false;   // the motion makes them touch, or overlap deeper than at rest
  bool too_close = false;  // the motion brings them closer than required_mm
  bool at_rest = false;    // at rest they are closer than required_mm, or overlap too deeply
  bool coincide = false;   // large common volume although neither surface is deep in the other

  /// The moment of largest depth beyond rest, else of least distance; the first of several.
  struct Worst {
    MotionTime when;
    PairSample sample;
    PairMeasure measure;
    BodyPoses poses;
  } worst;
  // Translation that separates a segment or transplant, B, from A when they overlap too deeply at
  // rest. Absent for open surfaces, which have no inside.
  std::optional<Eigen::Vector3d> push_out_mm;

  std::vector<double> clearance_mm;  // one per frame; negative: depth of the overlap

  bool violated() const { return collides || too_close || at_rest || coincide; }
  /// The rule is kept without contact, and asks for no gap between a least and a greatest value.
  bool stays_apart() const {
    return !violated() && rule.policy != PairPolicy::guided && rest_depth_mm <= 0 &&
           beyond_rest_mm <= 0 && !first_touch;
  }
};

struct ClearanceCheck {
  std::vector<PairVerdict> pairs;
  double margin_mm = 0;
  std::vector<double> time_s, opening_mm, rotation_deg;  // one per frame
  int samples_between = 0;                               // additional samples taken between frames
  std::string pairs_csv;                                 // a row per pair and frame

  std::vector<CoronoidSide> coronoids;
  std::string coronoids_missing;  // reason, when a side or both cannot be measured
  std::vector<ToothUse> teeth;    // of parts with separate crowns

  int frames() const { return static_cast<int>(time_s.size()); }
  /// Frame of largest opening; the first of several.
  std::size_t widest_frame() const;
  bool violated() const;
  /// `pictures`: file name of each pair's picture in the report's folder, or empty; may be shorter
  /// than the list of pairs.
  std::string json(const Scene& scene, const Motion& motion,
                   const std::vector<std::string>& pictures = {},
                   const std::vector<std::string>& notes = {}) const;
  std::string text() const;
};

struct CheckSettings {
  double margin_mm = 0;  // clearance required of forbidden pairs whose rule sets no margin
  CheckSampling sampling = {};
};

/// Samples the motion as prescribed, without stopping at contacts, and reports where bones meet and
/// which rules are broken. Deterministic: bit-identical for any number of threads.
ClearanceCheck check_clearance(const Scene& scene, const Motion& motion, const CheckSettings& check,
                               const SimulatorSettings& settings, const Progress& progress = {});

/// Applies a pair's rule to its measurements. `slack_mm`: depth beyond rest that is tolerated.
void apply_rule(PairVerdict& pair, double slack_mm);

/// One decimal, as in "12.3"; values that round to zero have no sign.
std::string tenths(double value);

/// The rule as text: "must not touch", "may touch, ...".
std::string rule_text(const PairVerdict& pair);

/// Says in one sentence which rule was broken and by how much, or which clearance was kept.
std::string verdict_text(const PairVerdict& pair);

}  // namespace condyle
