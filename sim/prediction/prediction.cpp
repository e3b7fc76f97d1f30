#include "sim/prediction/prediction.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "sim/prediction/operated_tissue.h"
#include "sim/tissue/lips.h"

namespace condyle {
namespace {

constexpr std::array soft_landmarks{
    "pronasale",      "columella",        "subnasale",         "left_alare",
    "right_alare",    "labrale_superius", "stomion",           "left_cheilion",
    "right_cheilion", "labrale_inferius", "soft_b_point",      "soft_pogonion",
    "soft_menton",    "left_soft_gonion", "right_soft_gonion", "cervical_point"};

bool is_identity(const Pose& pose) { return pose.R.vec().isZero(0) && pose.t.isZero(0); }

Eigen::Vector3d center_of(const Case& patient, BodyId body) {
  Box box;
  for (const Part& part : patient.parts)
    if (part.body == body) box.add(bounding_box(part.mesh));
  return box.empty() ? Eigen::Vector3d::Zero() : box.center();
}

/// How far the displayed face moves in further rounds of an equilibrium that was not reached.
double change_of_face(const Prediction& prediction, TissueState state, int threads) {
  constexpr int rounds = 3;
  const TissueModel& tissue = *prediction.tissue;
  TissueWarmStart warm;
  std::vector<Eigen::Vector3f> face;
  float most = 0;
  for (int round = 0; round < rounds; ++round) {
    state = solve_tissue(
        tissue, state, state.X_CB,
        {.tolerance_mm = equilibrium_mm, .contact_firmness = 10, .threads = threads}, warm);
    deform_face(tissue, state, face, threads);
    for (std::size_t i = 0; i < face.size(); ++i)
      most = std::max(most, (face[i] - prediction.after[i]).norm());
  }
  return most;
}

}  // namespace

double Prediction::max_displacement_mm() const {
  float most = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    most = std::max(most, (after[i] - before[i]).norm());
  return most;
}

std::vector<Pose> poses_at(const Operated& operated, double fraction) {
  std::vector<Pose> poses = operated.poses.X_CB;
  for (std::size_t i = 0; i < poses.size(); ++i)
    poses[i] = interpolate({}, poses[i], fraction,
                           center_of(operated.patient, BodyId{static_cast<int>(i)}));
  return poses;
}

Prediction predict(const Case& patient, const Plan& plan, const PredictionSettings& settings,
                   const Progress& progress) {
  if (!patient.find(Role::face))
    throw InputError(
        "the patient has no face: its position after the operation cannot be "
        "predicted");
  Prediction prediction;
  report(progress, "replaying the plan", 0);
  prediction.operated = apply_plan(patient, plan);
  Case uncut = patient;
  part_lips(uncut);
  prediction.face = uncut.find(Role::face)->mesh;
  TissueSettings of_tissue = settings.tissue;
  of_tissue.threads = settings.threads;
  const auto whole = build_tissue(uncut, of_tissue, progress);
  const auto start = std::chrono::steady_clock::now();
  OperatedTissue held = operated_tissue(uncut, whole, prediction.operated, plan, settings.stripping,
                                        settings.threads);
  prediction.tissue = std::move(held.model);
  prediction.stripping = std::move(held.stripping);

  TissueState state = rest_tissue(*whole);
  deform_face(*whole, state, prediction.before, settings.threads);
  const auto& planned = prediction.operated.poses.X_CB;
  if (!std::all_of(planned.begin(), planned.end(), is_identity)) {
    TissueWarmStart warm;
    const TissueBudget budget{.threads = settings.threads};
    for (int step = 1; step <= settings.steps; ++step) {
      report(progress, "moving the segments", static_cast<double>(step) / settings.steps);
      const double fraction = static_cast<double>(step) / settings.steps;
      state = solve_tissue(
          *prediction.tissue, state,
          step < settings.steps ? poses_at(prediction.operated, fraction) : planned, budget, warm);
      if (state.reused)
        throw MachineError("the face cannot be predicted: the tissue has no solution at " +
                           std::to_string(100 * step / settings.steps) + " % of the plan's moves");
    }
    report(progress, "solving the face to equilibrium", 1);
    state = solve_to_equilibrium(*prediction.tissue, state, equilibrium_mm, settings.threads,
                                 std::move(warm));
  }
  deform_face(*prediction.tissue, state, prediction.after, settings.threads);
  if (!state.converged)
    prediction.unsettled_mm = change_of_face(prediction, state, settings.threads);
  for (const char* name : soft_landmarks)
    if (const auto rest = patient.landmarks.find(name))
      prediction.points.push_back({name, *rest, carried_point(*prediction.tissue, state, *rest)});
  prediction.state = std::move(state);
  prediction.time_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return prediction;
}

}  // namespace condyle
