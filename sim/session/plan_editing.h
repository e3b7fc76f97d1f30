#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/case/case.h"
#include "sim/choice/plan_view.h"
#include "sim/session/operation_findings.h"
#include "sim/session/plan_document.h"

namespace condyle {

/// A plan after an edit, and the edit in words: "move maxilla".
struct EditedPlan {
  Plan plan;
  std::string what;
  int step = 0;  // that was added or changed, by id; 0: none
};

/// Displacements of segments that a hand holds, from their planned positions, in the cranium's
/// frame; by name of the body.
using HeldSegments = std::map<std::string, Pose>;

/// The plan after an edit other than undo, redo and placing by the bite. `uncut`: the case of the
/// plan; `operated`: the plan as it is on that case. A new osteotomy has its standard parameters. A
/// segment's position by hand becomes a move about its usual point, and segments that were cut from
/// it and moved go along. throws: InputError for an edit that the plan or the patient does not
/// allow.
EditedPlan edited_plan(const Case& uncut, const Plan& plan, const Operated& operated,
                       const PlanEdit& edit, const HeldSegments& held = {});

/// Where the segments of an operated patient go, from their planned positions, by a plan with other
/// moves: in the frames of their parents, by body; none where they stay. Empty for a plan that also
/// has other cuts.
std::vector<std::optional<Pose>> changed_positions(const Operated& operated, const Plan& before,
                                                   const Plan& after);

/// Sets the displacements and the cephalometry of a view to those with segments where hands hold
/// them.
void show_tables(PlanView& view, const Plan& plan, const Operated& operated,
                 const HeldSegments& held = {});

/// What a front end shows of a plan: steps with their findings, overlaps, displacements and
/// cephalometry. `operated`: the plan on its case; `findings`: of it.
PlanView plan_view(const PlanDocument& document, const Operated& operated,
                   const OperationFindings& findings);

}  // namespace condyle
