#include "sim/session/plan_stages.h"

#include <utility>

#include "engine/core/error.h"

namespace condyle {

PlanStages::PlanStages(const SessionPatient& patient, SimulatorSettings settings)
    : folder_(patient.folder),
      uncut_(patient.uncut),
      prepared_(with_muscles(*patient.uncut)),
      settings_(std::move(settings)) {
  if (!patient.scene.plan) whole_ = patient.scene.tissue;
}

Operated PlanStages::replay(const Plan& plan) {
  const std::lock_guard lock(replaying_);
  if (!plan_ || !have_same_cuts(*plan_, plan)) {
    plan_.reset();
    cuts_ = apply_cuts(prepared_, plan);
  }
  plan_ = plan;
  return with_moves(cuts_, plan);
}

PlanStages::Made PlanStages::pieces(const Plan& plan, Operated operated) const {
  auto shared = std::make_shared<const Operated>(operated);
  return completed_patient(
      {.folder = folder_,
       .scene = scene_without_contact(operate(prepared_, plan, std::move(operated))),
       .uncut = uncut_,
       .operated = shared,
       .findings = find_in_grafts(*shared)});
}

PlanStages::Made PlanStages::with_contact(const SessionPatient& pieces, const Plan& plan,
                                          const SessionPatient& earlier,
                                          const Progress& progress) const {
  report(progress, "measuring overlaps", 0);
  OperationFindings findings = pieces.findings;
  findings.overlaps = segment_overlaps(*pieces.operated);
  return completed_patient(
      {.folder = folder_,
       .scene = scene_with_contact(operate(prepared_, plan, *pieces.operated), settings_,
                                   &earlier.scene.contacts, progress),
       .uncut = uncut_,
       .operated = pieces.operated,
       .findings = std::move(findings),
       .surfaces = pieces.surfaces});
}

PlanStages::Made PlanStages::with_face(const SessionPatient& bones, const Plan& plan,
                                       const Progress& progress) {
  SessionPatient made = bones;
  try {
    const std::lock_guard lock(predicting_);
    if (!predictor_)
      predictor_.emplace(prepared_, prediction_settings(prepared_, settings_), whole_);
    made.scene = scene_with_face(bones.scene, predictor_->predict(plan, progress), settings_);
  } catch (const InputError& error) {
    made.trouble = std::string("The soft tissue is left out. ") + error.what();
  }
  return completed_patient(std::move(made));
}

}  // namespace condyle
