#include "sim/operation/edit_cut.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "engine/core/error.h"
#include "sim/osteotomy/osteotomy.h"

namespace condyle {
namespace {

/// The patient on which a step cuts.
Case patient_before(const Case& uncut, Plan plan, int id) {
  const auto at = plan.steps.begin() + (&step_of(plan, id) - plan.steps.data());
  plan.steps.erase(at, plan.steps.end());
  std::erase_if(plan.steps, [](const PlanStep& step) {
    return !std::holds_alternative<CutStep>(step.action) &&  // cuts are made at the uncut rest
           !std::holds_alternative<ResectStep>(step.action);
  });
  return apply_plan(uncut, plan).patient;
}

/// A step whose parameters now make other segments takes their names.
void name_segments(CutStep& cut, const CutStep& before, const Case& patient) {
  if (cut.osteotomy.empty() || !cut.surfaces.empty()) return;
  const auto names = segment_names(patient, cut);
  try {
    if (segment_names(patient, before) == names) return;
  } catch (const InputError&) {  // the step was wrong, and is corrected now
  }
  cut.pieces = names;
}

}  // namespace

std::vector<std::string> segment_names(const Case& patient, CutStep step) {
  step.pieces.clear();
  std::vector<std::string> names;
  for (const SegmentRule& rule : place_osteotomy(patient, step).segments)
    names.push_back(rule.name);
  return names;
}

Plan with_changed_cut(const Case& uncut, const Plan& plan, int id, CutStep cut, bool keeps_names) {
  const auto& before = std::get<CutStep>(step_of(plan, id).action);
  if (!keeps_names) name_segments(cut, before, patient_before(uncut, plan, id));
  return with_recut(plan, id, cut);
}

std::string dangers_below_margins(const Operated& operated, int step) {
  std::vector<std::string> dangers;
  for (const CutReport& cut : operated.cuts) {
    if (cut.step != step || cut.below_margins) continue;
    bool interdental = false;
    for (const DangerFinding& finding : cut.dangers) {
      if (finding.level != DangerLevel::stop) continue;
      dangers.push_back(danger_text(finding));
      interdental = interdental || finding.interdental;
    }
    if (interdental) dangers.insert(dangers.end(), cut.rooms.begin(), cut.rooms.end());
  }
  for (const TrimReport& trim : operated.trims) {
    if (trim.step != step || trim.below_margins) continue;
    for (const DangerFinding& finding : trim.dangers)
      if (finding.level == DangerLevel::stop) dangers.push_back(danger_text(finding));
  }
  return fmt::format("{}", fmt::join(dangers, "; "));
}

}  // namespace condyle
