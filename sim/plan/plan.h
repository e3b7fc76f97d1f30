#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "engine/math/pose.h"
#include "sim/frame/body_tree.h"
#include "sim/plan/case_geometry.h"
#include "sim/plan/clinical_frame.h"
#include "sim/plan/graft_step.h"
#include "sim/plan/move.h"
#include "sim/plan/plan_zone.h"

namespace condyle {

constexpr double max_kerf_mm = 2;

/// A rectangle of a plane: half its size along `axis`, and along normal x axis. The axis is
/// projected on the plane.
struct PatchRectangle {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  double half_along_mm = 0, half_across_mm = 0;

  bool operator==(const PatchRectangle&) const = default;
};

/// A finite part of a plane around a point: a disc of this radius, or a rectangle.
struct PlanePatch {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // towards the side called "above"
  std::variant<double, PatchRectangle> reach = 0.0;

  bool operator==(const PlanePatch&) const = default;
};

/// A polyline on the bone, extruded by `depth_mm` along a direction into the bone, and by
/// `overhang_mm` against it.
struct BentSheet {
  std::vector<Eigen::Vector3d> polyline = {};
  Eigen::Vector3d direction = Eigen::Vector3d::UnitY();
  double depth_mm = 0;
  double overhang_mm = 5;

  bool operator==(const BentSheet&) const = default;
};

using CutSurface = std::variant<PlanePatch, BentSheet>;

/// An osteotomy: one that is known by name and placed from landmarks, with parameters in which it
/// deviates from its defaults, or surfaces, which replace the placed ones.
struct CutStep {
  std::string osteotomy = {};  // such as "le_fort_1"; empty: the surfaces alone
  std::string target = {};     // body or segment that is cut; empty: that of the osteotomy
  std::string bone = {};       // its part that is cut, where it has several; empty: the first
  std::map<std::string, double> parameters = {};
  double kerf_mm = 0;
  std::vector<CutSurface> surfaces = {};
  std::vector<std::string> pieces = {};  // names of the segments that it makes
  bool below_margins = false;  // on request: it may lie too near to a root, canal or foramen

  bool operator==(const CutStep&) const = default;
};

/// X_CS of a segment from the uncut rest.
struct ExplicitMove {
  Pose X_CS = {};

  bool operator==(const ExplicitMove& other) const {
    return X_CS.R.coeffs() == other.X_CS.R.coeffs() && X_CS.t == other.X_CS.t;
  }
};

/// A move of a body or segment, always from the uncut rest: of several the last one counts.
struct MoveStep {
  std::string segment = {};
  std::variant<ClinicalMove, ExplicitMove> move = {};

  bool operator==(const MoveStep&) const = default;
};

/// Removes from a segment the bone that lies beyond the cut faces of other segments at the planned
/// positions. Trims are replayed after all cuts and moves, in their order.
struct TrimStep {
  std::string segment = {};
  std::vector<std::string> of = {};  // the segments that keep their bone
  bool below_margins = false;        // on request, as for a cut

  bool operator==(const TrimStep&) const = default;
};

struct NoteStep {
  std::string text = {};

  bool operator==(const NoteStep&) const = default;
};

using PlanAction = std::variant<CutStep, MoveStep, TrimStep, NoteStep, ResectStep, GraftStep>;

struct PlanStep {
  int id = 0;  // stays with the step when others are added, removed or reordered
  PlanAction action = {};

  bool operator==(const PlanStep&) const = default;
};

/// An operation as an ordered list of steps, bound to a case by its geometry.
struct Plan {
  std::string name = {};
  CaseGeometry geometry = {};  // of the case that it was made for
  HeadReference reference = {};
  std::vector<PlanStep> steps = {};
  std::vector<PlanZone> zones = {};  // the user's own danger zones, at the uncut rest

  bool operator==(const Plan&) const = default;
};

/// "cut le_fort_1", "move maxilla", "note": a step in a list or a message.
std::string step_title(const PlanAction& action);

// Edits are new plans. throws: InputError for an id that the plan lacks, naming those that it has,
// and as check_plan() for the new plan.
Plan with_step(Plan plan, PlanAction action);  // appended, with a new id
Plan with_replaced(Plan plan, int id, PlanAction action);
/// Replaces the segment's move, or appends it where the segment has none.
Plan with_move(Plan plan, const MoveStep& move);
Plan without_step(Plan plan, int id);
Plan with_reordered(Plan plan, int id, std::size_t position);  // 0: first
/// Adds a danger zone, or replaces the one of its name.
Plan with_zone(Plan plan, PlanZone zone);
/// throws: InputError for a name that the plan lacks.
Plan without_zone(Plan plan, const std::string& name);
/// Replaces a cut. Where it makes as many segments as before under other names, the other steps
/// follow: what moved or cut the old segment does the same to the new one.
Plan with_recut(Plan plan, int id, const CutStep& cut);

/// throws: InputError for an id that the plan lacks, naming those that it has.
const PlanStep& step_of(const Plan& plan, int id);

/// Refuses what no case could replay: values that are not finite or out of range, cuts without
/// osteotomy and surfaces, names of pieces that are used twice, and steps that cut, move or trim a
/// segment which a later step makes. throws: InputError naming step, item and value.
void check_plan(const Plan& plan);

/// The segments that a step cuts, moves or trims, by name; empty names: those of the osteotomy.
std::vector<std::string> used_segments(const PlanAction& action);

/// Refuses steps that cut, move or trim what is neither a body of the case nor made by an earlier
/// cut, as after a cut was removed. throws: InputError naming the step and the segment.
void check_segments(const Plan& plan, const BodyTree& bodies);

/// A value of a step that is refused: the item's name within it ("surfaces[0].normal").
struct StepProblem {
  std::string item, problem;
};
/// The first such value of a step by itself; absent if there is none.
std::optional<StepProblem> problem_of(const PlanAction& action);

/// "step 3 (move maxilla)".
std::string step_name(const PlanStep& step);

}  // namespace condyle
