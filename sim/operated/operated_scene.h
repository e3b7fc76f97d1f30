#pragma once

#include <optional>
#include <string>

#include "sim/operation/operation.h"
#include "sim/prediction/prediction.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// The patient at the planned positions, which are its rest, with muscles on their owners.
struct OperatedPatient {
  Case patient;
  ScenePlan plan;
  Operated operated;
  bool changed = true;  // false: a plan without cuts and moves; `patient` is the one given
};

/// The patient with the muscles that a plan moves: default ones where the case has none, and none
/// where their landmarks are missing.
Case with_muscles(Case patient);

/// Replays the plan. Muscles keep their optimal lengths from before the operation; a case without
/// muscles gets the default ones, fitted before it. The face is as before.
/// throws: InputError as apply_plan().
OperatedPatient operate(const Case& patient, const Plan& plan);
/// The same of a plan replayed already. `uncut`: with_muscles().
OperatedPatient operate(const Case& uncut, const Plan& plan, Operated operated);

/// Settings of a prediction whose tissue has the patient's muscles of the face.
PredictionSettings prediction_settings(const Case& uncut, const SimulatorSettings& settings);

/// The stages of make_operated_scene(), for a front end that shows each. First the bones at their
/// planned positions, passing through each other.
Scene scene_without_contact(const OperatedPatient& after);
/// Then they collide. `earlier`: of the patient before, see ContactModel; may be null.
/// throws: InputError as make_scene().
Scene scene_with_contact(const OperatedPatient& after, const SimulatorSettings& settings,
                         const ContactModel* earlier, const Progress& progress = {});
/// Then the face follows: `bones` with the tissue and face of a prediction of its plan.
Scene scene_with_face(const Scene& bones, const Prediction& prediction,
                      const SimulatorSettings& settings);

/// The scene of a patient after the operation. The planned positions are the rest of bones, contact
/// and motion. The tissue is the predicted one (see predict()), whose further deformation starts
/// there. Without cuts and moves the scene is bit-identical to make_scene() but for Scene::plan.
/// The face is predicted where the settings request tissue or face.
/// throws: InputError as apply_plan() and make_scene(); MachineError where the tissue of the
/// prediction has no solution.
Scene make_operated_scene(Case patient, const Plan& plan, const SimulatorSettings& settings = {},
                          const Progress& progress = {});

/// make_operated_scene() with a plan, else make_scene().
Scene make_scene(Case patient, const std::optional<Plan>& plan,
                 const SimulatorSettings& settings = {}, const Progress& progress = {});

}  // namespace condyle
