#pragma once

#include <string>
#include <vector>

#include "sim/operation/operation.h"

namespace condyle {

/// What a cut did, in sentences: each saw cut ("le_fort_1: does not go through, 3.2 mm of bone left
/// at ..."), crossings, pieces with volumes, and notes.
std::vector<std::string> cut_sentences(const CutReport& report, const Landmarks& landmarks);

/// The bones of a body: what a cut made, or what stays.
struct BoneSummary {
  std::string name;         // of the body
  std::string parent;       // empty for the cranium
  bool is_segment = false;  // made by the plan
  double volume_mm3 = 0;
  bool closed = true;
  double trimmed_mm3 = 0;  // removed from it
};
/// Bodies that the plan's cuts made or changed and that have bone, in the order of the tree.
std::vector<BoneSummary> operated_bones(const Operated& operated);

/// The segments that the plan's cuts and grafts made, by the names of their bodies.
std::vector<std::string> operated_segments(const Operated& operated);

/// A step besides its title in one line: "makes chin; kerf 0.7 mm", "forward 4.0 mm; about
/// pogonion".
std::string step_details(const PlanAction& action);

/// The steps of a plan with their numbers, one a line.
std::string steps_text(const Plan& plan);

/// The plan's own danger zones with their margins, one a line.
std::string zones_text(const Plan& plan);

}  // namespace condyle
