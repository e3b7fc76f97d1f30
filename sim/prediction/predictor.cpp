#include "sim/prediction/predictor.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <future>
#include <string>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/user_cache.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/stored_tissue.h"

namespace condyle {
namespace {

constexpr std::array soft_landmarks{
    "pronasale",      "columella",        "subnasale",         "left_alare",
    "right_alare",    "labrale_superius", "stomion",           "left_cheilion",
    "right_cheilion", "labrale_inferius", "soft_b_point",      "soft_pogonion",
    "soft_menton",    "left_soft_gonion", "right_soft_gonion", "cervical_point"};

/// Iterations of a step on the way. Its contacts need not be exact: the end is settled.
constexpr int step_iterations = 60;
/// Of the solution to equilibrium. Where the lips roll on each other it may oscillate.
constexpr int max_rounds = 8;
bool is_identity(const Pose& pose) { return pose.R.vec().isZero(0) && pose.t.isZero(0); }

float largest_distance(const std::vector<Eigen::Vector3f>& a,
                       const std::vector<Eigen::Vector3f>& b) {
  float most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

/// How far the displayed face moves in further rounds of an equilibrium that was not reached.
double change_of_face(const Prediction& prediction, TissueState state, TissueWarmStart warm,
                      int threads) {
  constexpr int rounds = 3;
  const TissueModel& tissue = *prediction.tissue;
  std::vector<Eigen::Vector3f> face;
  float most = 0;
  for (int round = 0; round < rounds; ++round) {
    state = solve_tissue(tissue, state, state.X_CB,
                         {.tolerance_mm = equilibrium_mm,
                          .contact_firmness = 10,
                          .relaxed_contact = true,
                          .threads = threads},
                         warm);
    deform_face(tissue, state, face, threads);
    most = std::max(most, largest_distance(face, prediction.after));
  }
  return most;
}

}  // namespace

Predictor::Predictor(const Case& patient, PredictionSettings settings,
                     std::shared_ptr<const TissueModel> whole)
    : patient_(patient), uncut_(patient), settings_(std::move(settings)), whole_(std::move(whole)) {
  if (!patient.find(Role::face))
    throw InputError(
        "the patient has no face: its position after the operation cannot be "
        "predicted");
  part_lips(uncut_);
}

void Predictor::build_whole(const Progress& progress) {
  if (!whole_) {
    TissueSettings of_tissue = settings_.tissue;
    of_tissue.threads = settings_.threads;
    whole_ = stored_tissue(user_cache_folder(), uncut_, of_tissue, progress);
  }
  if (rest_face_.empty()) deform_face(*whole_, rest_tissue(*whole_), rest_face_, settings_.threads);
}

void Predictor::begin_at_rest() {
  state_ = rest_tissue(*whole_);
  warm_ = {};
}

const Operated& Predictor::prepare(const Plan& plan, const Progress& progress) {
  report(progress, "replaying the plan", 0);
  if (plan_ && have_same_cuts(*plan_, plan)) {
    operated_ = with_moves(cuts_, plan);
    plan_ = plan;
    return operated_;
  }
  plan_.reset();
  const bool beside = settings_.threads > 1 && !whole_;
  std::future<Operated> cuts = std::async(beside ? std::launch::async : std::launch::deferred,
                                          [&] { return apply_cuts(patient_, plan); });
  if (!beside) cuts.wait();
  build_whole(progress);
  cuts_ = cuts.get();
  operated_ = with_moves(cuts_, plan);
  tissue_ =
      operated_tissue(uncut_, whole_, operated_, plan, settings_.stripping, settings_.threads);
  plan_ = plan;
  begin_at_rest();
  return operated_;
}

/// Moves the bodies from rest to their planned poses and solves for equilibrium.
void Predictor::move_from_rest(const Progress& progress) {
  const TissueBudget budget{
      .max_iterations = step_iterations, .relaxed_contact = true, .threads = settings_.threads};
  for (int step = 1; step <= settings_.steps; ++step) {
    const double fraction = static_cast<double>(step) / settings_.steps;
    report(progress, "moving the segments", fraction);
    state_ =
        solve_tissue(*tissue_.model, state_,
                     step < settings_.steps ? poses_at(operated_, fraction) : operated_.poses.X_CB,
                     budget, warm_);
    if (!state_.reused) continue;
    begin_at_rest();
    throw MachineError("the face cannot be predicted: the tissue has no solution at " +
                       std::to_string(100 * step / settings_.steps) + " % of the plan's moves");
  }
  report(progress, "solving the face to equilibrium", 1);
  state_ = solve_to_equilibrium(*tissue_.model, state_, warm_,
                                {.max_rounds = max_rounds, .threads = settings_.threads});
}

Prediction Predictor::predict(const Plan& plan, const Progress& progress) {
  prepare(plan, progress);
  Prediction prediction;
  prediction.operated = operated_;
  prediction.tissue = tissue_.model;
  prediction.stripping = tissue_.stripping;
  prediction.face = uncut_.find(Role::face)->mesh;
  prediction.before = rest_face_;

  const auto start = std::chrono::steady_clock::now();
  const auto& planned = operated_.poses.X_CB;
  begin_at_rest();
  if (tissue_.grafted || !std::all_of(planned.begin(), planned.end(), is_identity))
    move_from_rest(progress);
  deform_face(*tissue_.model, state_, prediction.after, settings_.threads);
  if (!state_.converged)
    prediction.unsettled_mm = change_of_face(prediction, state_, warm_, settings_.threads);
  for (const char* name : soft_landmarks)
    if (const auto rest = patient_.landmarks.find(name))
      prediction.points.push_back({name, *rest, carried_point(*tissue_.model, state_, *rest)});
  prediction.state = state_;
  prediction.time_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return prediction;
}

MovedFace Predictor::move(const BodyPoses& poses, int max_iterations) {
  if (!plan_) throw InputError("the plan of a prediction must be prepared before segments move");
  state_ = solve_tissue(*tissue_.model, state_, poses.X_CB,
                        {.max_iterations = max_iterations,
                         .contact_firmness = 10,
                         .relaxed_contact = true,
                         .threads = settings_.threads},
                        warm_);
  MovedFace moved{state_, {}};
  deform_face(*tissue_.model, state_, moved.vertices, settings_.threads);
  return moved;
}

}  // namespace condyle
