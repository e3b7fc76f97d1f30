#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/case/muscle.h"
#include "sim/frame/before_operation.h"
#include "sim/frame/landmark_vertex.h"
#include "sim/plan/plan.h"
#include "sim/session/operation_findings.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// Facts on a patient's surfaces that take time to find.
struct SurfaceFacts {
  std::map<std::string, LandmarkVertex> landmarks = {};  // of each landmark of the case
  bool open = false;  // a surface that can collide is open: it has no inside
};

/// A patient of a session: the simulated scene, and what is reported of it.
struct SessionPatient {
  std::filesystem::path folder;  // empty: not stored in files
  Scene scene;
  FrameState at_rest = {};           // with its face
  std::vector<Muscle> muscles = {};  // the case's, or default ones; none without their landmarks
  std::string trouble = {};          // what had to be omitted, as a sentence
  std::shared_ptr<const Case> uncut = nullptr;         // before the operation of the plan
  std::shared_ptr<const Operated> operated = nullptr;  // by the plan, which may be empty
  OperationFindings findings = {};                     // of the operation
  std::optional<SurfaceFacts> surfaces = {};           // there in every completed patient
};

/// A plan without steps for a case.
Plan empty_plan(const Case& patient);

/// Builds the scene of a patient, without soft tissue when the face does not allow any: the bones
/// can still be moved. `plan`: of the operation after which the patient is shown.
/// throws: InputError.
std::shared_ptr<const SessionPatient> make_session_patient(Case patient,
                                                           std::filesystem::path folder,
                                                           SimulatorSettings settings,
                                                           const Progress& progress,
                                                           const std::optional<Plan>& plan = {});

/// The patient before the operation. Absent where nothing was moved, resected or grafted.
std::optional<BeforeOperation> before_operation(const SessionPatient& patient);

/// The patient with what follows from its scene: its state at rest, its muscles and, unless they
/// are there already, the facts on its surfaces.
std::shared_ptr<const SessionPatient> completed_patient(SessionPatient patient, int threads = 2);

}  // namespace condyle
