#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

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
  std::vector<PlanNumber> numbers = {};
};

/// A name in the program, and how it reads.
struct NamedItem {
  std::string name, label;
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
};

/// Edits of a plan that a user requests.
namespace plan_edit {
struct AddOsteotomy {
  std::string name;
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
/// Makes the positions of the segments that a hand holds those of the plan.
struct TakePositions {};
struct Undo {};
struct Redo {};
}  // namespace plan_edit

using PlanEdit =
    std::variant<plan_edit::AddOsteotomy, plan_edit::AddMove, plan_edit::SetNumber,
                 plan_edit::Remove, plan_edit::Shift, plan_edit::Occlude, plan_edit::Trim,
                 plan_edit::TakePositions, plan_edit::Undo, plan_edit::Redo>;

}  // namespace condyle
