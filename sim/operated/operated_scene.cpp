#include "sim/operated/operated_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.h"
#include "sim/motion/closed_position.h"
#include "sim/muscles/default_face_muscles.h"
#include "sim/muscles/default_muscles.h"
#include "sim/operated/graft_path.h"
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

ScenePlan identity_of(const Plan& plan) { return {.name = plan.name, .hash = plan_hash(plan)}; }

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

Case with_muscles(Case patient) {
  if (!patient.muscles.empty()) return patient;
  try {
    patient.muscles = muscles_of(patient);
  } catch (const InputError&) {
    // Landmarks are missing; a muscle-driven motion reports which.
  }
  return patient;
}

OperatedPatient operate(const Case& uncut, const Plan& plan, Operated operated) {
  if (!changes_patient(plan)) {
    OperatedPatient same{uncut, identity_of(plan), std::move(operated), false};
    same.plan.notes = same.operated.notes;
    return same;
  }
  OperatedPatient result{operated_case(operated), identity_of(plan), std::move(operated)};
  result.patient.notes = result.operated.patient.notes;
  result.plan.notes = result.operated.notes;
  for (const std::string& problem : result.operated.problems) result.plan.notes.push_back(problem);
  result.plan.muscles = changed_lengths(uncut, result.patient);
  result.plan.seats = graft_seats(result.operated, plan);
  return result;
}

OperatedPatient operate(const Case& patient, const Plan& plan) {
  const Case uncut = changes_patient(plan) ? with_muscles(patient) : patient;
  return operate(uncut, plan, apply_plan(uncut, plan));
}

Scene scene_without_contact(const OperatedPatient& after) {
  Case patient = after.patient;
  locate_closed_position(patient);
  ContactModel contacts = ContactModel::none(patient.bodies);
  return {std::move(patient), std::move(contacts), nullptr, after.plan};
}

Scene scene_with_contact(const OperatedPatient& after, const SimulatorSettings& settings,
                         const ContactModel* earlier, const Progress& progress) {
  report(progress, "building the collision models", 0);
  Case patient = after.patient;
  locate_closed_position(patient);
  ContactSettings of_contact = settings.contact;
  of_contact.advise_exits = false;
  ContactModel contacts(patient, of_contact, earlier);
  return {std::move(patient), std::move(contacts), nullptr, after.plan};
}

PredictionSettings prediction_settings(const Case& uncut, const SimulatorSettings& settings) {
  PredictionSettings of{
      .tissue = settings.tissue_model, .threads = settings.threads, .stripping = {}};
  of.tissue.face_muscles = muscles_of_face(uncut);
  return of;
}

Scene scene_with_face(const Scene& bones, const Prediction& prediction,
                      const SimulatorSettings& settings) {
  Scene scene = bones;
  for (Part& part : scene.patient.parts)
    if (part.role == Role::face) part.mesh = displaced(prediction.face, prediction.after);
  for (const SoftPoint& point : prediction.points)
    scene.patient.landmarks.points[point.landmark] = point.after;
  if (settings.tissue) scene.tissue = planned_tissue(prediction, settings.threads);
  return scene;
}

Scene make_operated_scene(Case patient, const Plan& plan, const SimulatorSettings& settings,
                          const Progress& progress) {
  if (!changes_patient(plan)) {
    OperatedPatient same = operate(patient, plan);
    Scene scene = make_scene(std::move(patient), settings, progress);
    scene.plan = std::move(same.plan);
    return scene;
  }
  if (!patient.find(Role::face) || !(settings.tissue || settings.face))
    return scene_with_contact(operate(patient, plan), settings, nullptr, progress);
  const Case uncut = with_muscles(std::move(patient));
  const Prediction prediction =
      predict(uncut, plan, prediction_settings(uncut, settings), progress);
  const Scene bones =
      scene_with_contact(operate(uncut, plan, prediction.operated), settings, nullptr, progress);
  if (settings.tissue) report(progress, "solving the tissue along the opening", 0.9);
  return scene_with_face(bones, prediction, settings);
}

Scene make_scene(Case patient, const std::optional<Plan>& plan, const SimulatorSettings& settings,
                 const Progress& progress) {
  return plan ? make_operated_scene(std::move(patient), *plan, settings, progress)
              : make_scene(std::move(patient), settings, progress);
}

}  // namespace condyle
