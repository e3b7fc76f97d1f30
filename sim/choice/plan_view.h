#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "sim/frame/body_tree.h"

namespace condyle {

/// A number of a step that can be edited: a parameter of an osteotomy, or of a move.
struct PlanNumber {
  std::string name = {}, label = {}, unit = {}, help = {};
  double low = 0, high = 0;  // accepted range
  double standard = 0, value = 0;
};

/// A step of a plan, as a front end shows it.
struct PlanStepView {
  int id = 0;
  std::string title = {};                  // "Cut: Le Fort I"
  std::string details = {};                // in one line, such as "forward 4.0, up 2.0 mm"
  std::vector<std::string> findings = {};  // what it does to the bone, in sentences
  bool warns = false;                      // whether one of them needs attention
  bool is_cut = false;                     // it may have handles
  std::vector<PlanNumber> numbers = {};
};

/// A name in the program, and how it reads.
struct NamedItem {
  std::string name, label;
};

/// A handle of a cut: dragged along an axis it sets a number of its step, dragged freely it places
/// a point of a drawn cut. Places are those of the patient as shown at rest, in the cranium's
/// frame.
struct PlanHandle {
  BodyId body = cranium_body;                    // that carries it
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // mm
  std::string number = {};                       // see PlanNumber; empty: a point
  Eigen::Vector3d per_unit =
      Eigen::Vector3d::Zero();  // its displacement for one unit of the number
  // Of the number, at this place. Other than the step's where danger zones hold the cut back.
  double value = 0;
  std::size_t surface = 0, point = 0;  // of the drawn cut
};

/// What a cut that is being drawn or changed would do.
struct CutPreviewView {
  std::string problem = {};  // why it cannot be made; empty: it can
  std::vector<std::string> findings = {};
  bool warns = false;
};

/// A measure before and after the operation, beside its norm.
struct PlanMeasure {
  std::string label, before, after, norm;
};

/// The plan of an operation and what follows from it, as a front end shows it.
struct PlanView {
  std::string name = {};
  std::filesystem::path file = {};  // empty: not saved yet
  std::vector<PlanStepView> steps = {};
  std::vector<NamedItem> osteotomies = {};  // that can be added
  std::vector<NamedItem> segments = {};     // without a move of their own
  std::vector<NamedItem> arches = {};       // segments that carry a dental arch
  std::vector<NamedItem> trimmed = {};      // segments whose overlap with others can be removed
  std::string undo = {}, redo = {};         // what they would reverse or repeat; empty: nothing
  std::vector<std::string> findings = {};   // overlaps at the planned positions, problems
  std::vector<PlanMeasure> displacements = {}, cephalometry = {};
  std::vector<NamedItem> resectable = {};   // segments that can be resected
  std::vector<NamedItem> replaceable = {};  // resected segments without a graft
  std::vector<NamedItem> donors = {};
  std::vector<NamedItem> splints = {};            // that can be made
  std::vector<std::string> splint_findings = {};  // of the splint made last
  int handles_of = 0;                             // id of the step whose handles are known; 0: none
  std::vector<PlanHandle> handles = {};
  std::optional<CutPreviewView> preview = {};
};

/// Edits of a plan that a user requests.
namespace plan_edit {
struct AddOsteotomy {
  std::string name;
};
/// A saw cut drawn on a bone as it is shown at rest, in the cranium's frame.
struct DrawCut {
  std::string part;  // the bone
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitY();  // into the bone
  double depth_mm = 0;                                   // 0: through the first wall of bone
  double kerf_mm = 0;
};
/// Places a point of a drawn cut; see PlanHandle.
struct MovePoint {
  int step = 0;
  std::size_t surface = 0, point = 0;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
};
struct AddMove {
  std::string segment;
};
/// Sets a number of a step, see PlanNumber.
struct SetNumber {
  int step = 0;
  std::string name;
  double value = 0;
};
struct Remove {
  int step = 0;
};
/// Puts a step one place earlier or later.
struct Shift {
  int step = 0;
  bool later = false;
};
/// Places a segment with a dental arch by its bite.
struct Occlude {
  std::string segment;
};
/// Removes the bone of a segment that overlaps other segments of its bone.
struct Trim {
  std::string segment;
};
/// Removes a segment from the patient.
struct Resect {
  std::string segment;
};
/// Places bone from a donor where a segment was resected.
struct Graft {
  std::string segment, donor;
};
/// Makes the positions of the segments that a hand holds those of the plan.
struct TakePositions {};
struct Undo {};
struct Redo {};
}  // namespace plan_edit

using PlanEdit =
    std::variant<plan_edit::AddOsteotomy, plan_edit::DrawCut, plan_edit::MovePoint,
                 plan_edit::AddMove, plan_edit::SetNumber, plan_edit::Remove, plan_edit::Shift,
                 plan_edit::Occlude, plan_edit::Trim, plan_edit::Resect, plan_edit::Graft,
                 plan_edit::TakePositions, plan_edit::Undo, plan_edit::Redo>;

}  // namespace condyle
