#include "sim/session/session_patient.h"

#include <algorithm>
#include <utility>

#include "engine/core/error.h"
#include "sim/contact/distance_map.h"
#include "sim/muscles/default_muscles.h"
#include "sim/operated/operated_scene.h"
#include "sim/operated/state_before.h"

namespace condyle {

Plan empty_plan(const Case& patient) {
  Plan plan;
  plan.name = "plan";
  plan.geometry = geometry_of(patient);
  return plan;
}

namespace {

SurfaceFacts surface_facts(const Case& patient) {
  SurfaceFacts facts{.open = has_open_surfaces(patient)};
  for (const auto& [name, at] : patient.landmarks.points)
    facts.landmarks[name] = landmark_vertex(name, at, patient.parts);
  return facts;
}

}  // namespace

std::shared_ptr<const SessionPatient> make_session_patient(Case patient,
                                                           std::filesystem::path folder,
                                                           SimulatorSettings settings,
                                                           const Progress& progress,
                                                           const std::optional<Plan>& plan) {
  std::string trouble;
  const auto build = [&]() -> Scene {
    while (true) {
      try {
        return make_scene(patient, plan, settings, progress);
      } catch (const InputError& error) {
        if (!settings.tissue) throw;
        bool& upper_face = settings.tissue_model.upper_face;
        trouble = upper_face ? "Brows and forehead are left out of the soft tissue. "
                             : "The soft tissue is left out. ";
        trouble += error.what();
        settings.tissue = upper_face;
        upper_face = false;
      }
    }
  };
  Scene scene = build();
  auto operated =
      std::make_shared<const Operated>(apply_plan(patient, plan ? *plan : empty_plan(patient)));
  OperationFindings findings = find_in_operation(*operated);
  return completed_patient({.folder = std::move(folder),
                            .scene = std::move(scene),
                            .trouble = std::move(trouble),
                            .uncut = std::make_shared<const Case>(std::move(patient)),
                            .operated = std::move(operated),
                            .findings = std::move(findings)},
                           settings.threads);
}

std::shared_ptr<const SessionPatient> completed_patient(SessionPatient patient, int threads) {
  auto made = std::make_shared<SessionPatient>(std::move(patient));
  made->at_rest = rest_frame(made->scene);
  carry_face(made->scene, made->at_rest, threads);
  if (!made->surfaces) made->surfaces = surface_facts(made->scene.patient);
  try {
    made->muscles = muscles_of(made->scene.patient);
  } catch (const InputError&) {
    // They were not requested; a muscle-driven motion states what is missing.
  }
  return made;
}

std::optional<BeforeOperation> before_operation(const SessionPatient& patient) {
  return before_operation(*patient.operated, patient.at_rest, *patient.uncut);
}

}  // namespace condyle
