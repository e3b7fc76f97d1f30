#include "sim/operated/operated_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/hash.h"
#include "sim/muscles/default_muscles.h"
#include "sim/operated/graft_way.h"
#include "sim/plan/plan_file.h"
#include "sim/prediction/prediction.h"
#include "sim/tissue/planned_rest.h"

namespace condyle {
namespace {

bool at_rest(const BodyPoses& poses) {
  return std::all_of(poses.X_CB.begin(), poses.X_CB.end(),
                     [](const Pose& X) { return bit_identical(X, {}); });
}

bool changes_patient(const Plan& plan) {
  return std::any_of(plan.steps.begin(), plan.steps.end(), [](const PlanStep& step) {
    return !std::holds_alternative<NoteStep>(step.action);
  });
}

ScenePlan identity_of(const Plan& plan) {
  const std::string text = plan_json(plan);
  return {.name = plan.name,
          .hash = fmt::format("{:016x}", hash_bytes(text.data(), text.size(), hash_start))};
}

/// The patient with muscles that a plan can move: default ones where the case has none.
Case with_muscles(Case patient) {
  if (!patient.muscles.empty()) return patient;
  try {
    patient.muscles = muscles_of(patient);
  } catch (const InputError&) {
    // Landmarks are missing; a muscle-driven motion reports which.
  }
  return patient;
}

std::vector<MuscleLengthChange> changed_lengths(const Case& before, const Case& after) {
  constexpr double least_mm = 0.05;
  const auto length = [](const Muscle& muscle) {
    return (muscle.insertion - muscle.origin).norm();
  };
  std::vector<MuscleLengthChange> changes;
  for (std::size_t i = 0; i < before.muscles.size(); ++i) {
    const double was = length(before.muscles[i]), is = length(after.muscles[i]);
    if (std::abs(is - was) >= least_mm) changes.push_back({before.muscles[i].name, was, is});
  }
  return changes;
}

/// The patient at the planned positions. `prepared`: of operate(), the uncut one with its muscles.
OperatedPatient at_planned_rest(const Case& prepared, const Plan& plan, Operated operated) {
  OperatedPatient result{operated_case(operated), identity_of(plan), std::move(operated)};
  result.patient.notes = result.operated.patient.notes;
  result.plan.notes = result.operated.notes;
  for (const std::string& problem : result.operated.problems) result.plan.notes.push_back(problem);
  result.plan.muscles = changed_lengths(prepared, result.patient);
  result.plan.seats = graft_seats(result.operated, plan);
  return result;
}

TriMesh displaced(TriMesh mesh, const std::vector<Eigen::Vector3f>& vertices) {
  for (std::size_t i = 0; i < vertices.size(); ++i) mesh.vertices[i] = vertices[i].cast<double>();
  return mesh;
}

/// The tissue at the planned rest, of a prediction.
std::shared_ptr<const TissueModel> planned_tissue(const Prediction& prediction, int threads) {
  if (at_rest(prediction.operated.poses)) return prediction.tissue;
  return with_planned_rest(*prediction.tissue, prediction.state, threads);
}

}  // namespace

OperatedPatient operate(const Case& patient, const Plan& plan) {
  if (!changes_patient(plan)) {
    OperatedPatient same{patient, identity_of(plan), apply_plan(patient, plan), false};
    same.plan.notes = same.operated.notes;
    return same;
  }
  const Case prepared = with_muscles(patient);
  return at_planned_rest(prepared, plan, apply_plan(prepared, plan));
}

Scene make_operated_scene(Case patient, const Plan& plan, const SimulatorSettings& settings,
                          const Progress& progress) {
  const bool predicts =
      changes_patient(plan) && patient.find(Role::face) && (settings.tissue || settings.face);
  std::optional<Prediction> prediction;
  OperatedPatient after;
  if (predicts) {
    const Case prepared = with_muscles(std::move(patient));
    prediction = predict(
        prepared, plan,
        {.tissue = settings.tissue_model, .threads = settings.threads, .stripping = {}}, progress);
    after = at_planned_rest(prepared, plan, prediction->operated);
    for (Part& part : after.patient.parts)
      if (part.role == Role::face) part.mesh = displaced(prediction->face, prediction->after);
  } else {
    after = operate(patient, plan);
  }
  if (!after.changed) {
    Scene scene = make_scene(std::move(patient), settings, progress);
    scene.plan = std::move(after.plan);
    return scene;
  }
  SimulatorSettings bones = settings;
  bones.tissue = false;
  Scene scene = make_scene(std::move(after.patient), bones, progress);
  scene.plan = std::move(after.plan);
  if (prediction && settings.tissue) {
    report(progress, "solving the tissue along the opening", 0.9);
    scene.tissue = planned_tissue(*prediction, settings.threads);
  }
  return scene;
}

Scene make_scene(Case patient, const std::optional<Plan>& plan, const SimulatorSettings& settings,
                 const Progress& progress) {
  return plan ? make_operated_scene(std::move(patient), *plan, settings, progress)
              : make_scene(std::move(patient), settings, progress);
}

}  // namespace condyle
