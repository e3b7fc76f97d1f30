#pragma once

#include <map>
#include <string>
#include <vector>

#include "engine/cut/cut.h"
#include "sim/case/case.h"
#include "sim/plan/plan.h"

namespace condyle {

/// A segment that an osteotomy makes: the pieces that lie on these sides of its cuts. `neither`
/// accepts any side. A piece belongs to the first rule that it meets.
struct SegmentRule {
  std::string name;            // "maxilla", "proximal_left"
  std::vector<CutSide> sides;  // one per cut
};

/// A place of a cut that one parameter moves, such as a bend or a station of its sheet.
struct CutStation {
  std::string parameter;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();        // in the cranium's frame, at rest
  Eigen::Vector3d per_unit = Eigen::Vector3d::Zero();  // how the parameter displaces it
};

/// An osteotomy in place on a patient's bone: ready to cut.
struct PlacedOsteotomy {
  std::string part;                     // name of the bone that is cut
  std::vector<Cut> cuts;                // in the cranium's frame, at rest
  std::vector<SegmentRule> segments;    // other pieces stay with the bone's own body
  std::vector<std::string> notes;       // what was estimated, for people
  std::vector<std::string> rooms = {};  // between the teeth of interdental cuts, for people
  std::vector<int> removed_teeth = {};  // FDI numbers: leave with a segment, and may be divided
  std::vector<CutStation> stations = {};
};

/// The segment that a piece belongs to; -1: it stays with the bone's own body.
int segment_of(const PlacedOsteotomy& placed, const Piece& piece);

/// A parameter that a plan may change.
struct OsteotomyParameter {
  std::string name, unit, meaning;
  double standard = 0, low = 0, high = 0;  // default and bounds
};

/// Names of all osteotomies that can be placed from landmarks: "le_fort_1", ...
std::vector<std::string> osteotomy_names();
/// throws: InputError for an unknown name, with similar ones.
std::vector<OsteotomyParameter> osteotomy_parameters(const std::string& name);
/// Thickness of the saw cut where a plan gives none: 1.2 of a craniotome, 2 of staves, else 0.
double default_kerf_mm(const std::string& osteotomy);

/// Places a plan's cut on a patient: from landmarks and the bone's shape, or where the step has
/// surfaces from those. The step's pieces name all segments in order, or some by their own names:
/// the others then stay with the bone's body. With surfaces, the i-th piece lies above the i-th
/// surface, and one more below all; the side above a sheet is the left of its polyline, seen
/// from outside the bone. throws: InputError naming a missing landmark or part, an unknown
/// parameter, or one out of its bounds.
PlacedOsteotomy place_osteotomy(const Case& patient, const CutStep& step);

}  // namespace condyle
