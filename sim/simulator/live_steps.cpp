#include "sim/simulator/live_steps.h"

#include <algorithm>

#include "sim/muscles/expression_names.h"

namespace condyle {
namespace {

/// A time farther ahead than this is a jump of the scrub bar.
constexpr double jump_s = 0.25;
constexpr int settling_iterations = 30;

}  // namespace

TissueBudget live_budget(TissueBudget keeping_up, bool settles, bool jaw_teleports,
                         bool reused_before) {
  keeping_up.damped_contact = settles;
  if (settles) keeping_up.max_iterations = std::max(keeping_up.max_iterations, settling_iterations);
  if (jaw_teleports || reused_before) keeping_up.max_iterations = TissueBudget{}.max_iterations;
  return keeping_up;
}

LiveSteps::LiveSteps(const Scene& scene, const Motion& motion, const Motion& opening,
                     const SimulatorSettings& settings)
    : scene_(scene),
      motion_(motion),
      opening_(opening),
      settings_(settings),
      opening_times_(scene.patient, opening),
      teleport_start_(scene, settings.threads),
      now_(rest_frame(scene)),
      X_PB_moved_(scene.patient.bodies.bodies().size()) {}

bool LiveSteps::runs_on(const LiveRequest& request) const {
  const double ahead_s = request.time_s - now_.time_s;
  return !request.opening_mm && ahead_s > 1.5 * settings_.step_s && ahead_s < jump_s;
}

StepInput LiveSteps::input(const LiveTarget& target, double time_s, bool shown) {
  for (std::size_t b = 0; b < X_PB_moved_.size(); ++b)
    if (target.X_PB_held[b]) X_PB_moved_[b] = *target.X_PB_held[b];
  const auto& opening_mm = target.request.opening_mm;
  const Pose X_CM =
      opening_mm ? opening_.target(opening_times_.time_of(*opening_mm)) : motion_.target(time_s);
  StepInput input{.time_s = time_s,
                  .X_PB_target = motion_target_poses(
                      scene_.patient.bodies, X_CM,
                      motion_.pieces && !opening_mm ? motion_.pieces(time_s) : X_PB_moved_),
                  .obey_contact = target.request.obey_contact};
  input.bound_far = !shown;
  input.excitation = excitation(target.request, time_s);
  for (std::size_t b = 0; b < X_PB_moved_.size(); ++b)
    if (target.X_PB_held[b]) input.X_PB_target[b] = *target.X_PB_held[b];
  return input;
}

/// Of the face: that of the motion and that of the request, added up.
FaceExcitation LiveSteps::excitation(const LiveRequest& request, double time_s) const {
  if (!scene_.tissue) return {};
  FaceExcitation requested;
  if (!request.expression.empty())
    requested = excitation_of(request.expression, face_muscles_of(*scene_.tissue));
  if (!motion_.expression) return requested;
  return added_excitations(motion_.expression(time_s), requested);
}

void LiveSteps::begin_at(const BodyPoses& poses) {
  const BodyId jaw = scene_.patient.jaw.lower_arch;
  // The tissue has no path on which it could follow.
  if (scene_.tissue && is_teleport(now_.poses[jaw], poses[jaw])) {
    now_.tissue = rest_tissue(*scene_.tissue);
    warm_ = {};
  }
  now_.poses = poses;
  now_.contacts = scene_.contacts.find(poses, nullptr, settings_.threads);
}

TeleportStart::Asked LiveSteps::asked(const LiveTarget& target, const StepInput& input) const {
  TeleportStart::Asked asked{target.request, input.X_PB_target,
                             std::vector<bool>(X_PB_moved_.size())};
  for (std::size_t b = 0; b < X_PB_moved_.size(); ++b)
    asked.follows_motion[b] =
        !target.X_PB_held[b] &&
        (motion_.pieces || scene_.patient.bodies.moved_by_motion(BodyId{static_cast<int>(b)}));
  return asked;
}

SimulatorSettings LiveSteps::settings_for(const LiveTarget& target, const StepInput& input) const {
  const BodyId jaw = scene_.patient.jaw.lower_arch;
  SimulatorSettings settings = settings_;
  // Invisible soft tissue is not stepped; it continues later from its last state.
  settings.tissue = settings.tissue && target.request.face;
  const bool jaw_teleports = is_teleport(pose_in(now_.tissue.X_CB, jaw),
                                         placed(scene_.patient.bodies, input.X_PB_target)[jaw]);
  settings.tissue_budget =
      live_budget(settings.tissue_budget, settling_ > 0, jaw_teleports, now_.tissue.reused);
  return settings;
}

void LiveSteps::keep_moved(const LiveTarget& target) {
  const BodyTree& bodies = scene_.patient.bodies;
  for (int b = 1; b < bodies.size(); ++b)
    if (const auto i = static_cast<std::size_t>(b); target.X_PB_held[i])
      X_PB_moved_[i] = pose_in(bodies[BodyId{b}].parent, BodyId{b}, now_.poses);
}

void LiveSteps::count_settling(bool tissue) {
  const bool settles = settling_ > 0;
  const bool settled = !tissue || now_.tissue.converged || (settles && now_.tissue.reused);
  settling_ = settled ? 0 : settles ? settling_ - 1 : max_settling;
}

void LiveSteps::step(const LiveTarget& target, bool shown) {
  const bool under_way = runs_on(target.request);
  const double time_s = under_way ? now_.time_s + settings_.step_s : target.request.time_s;
  StageTimes motion_time;
  StepInput step_input;
  {
    const StageTimer timer(motion_time, Stage::motion);
    step_input = input(target, time_s, shown);
  }
  const TeleportStart::Asked question = asked(target, step_input);
  if (const auto start = teleport_start_.of(question, now_, target.grips != answered_grips_))
    begin_at(*start);
  const SimulatorSettings settings = settings_for(target, step_input);
  now_ = condyle::step(scene_, now_, step_input, settings, warm_);
  now_.times[Stage::motion] = motion_time[Stage::motion];
  keep_moved(target);
  count_settling(settings.tissue);
  caught_up_ = !under_way;
  if (caught_up_) {
    answered_ = target.request;
    answered_grips_ = target.grips;
    teleport_start_.ended(question, now_);
  }
  if (shown && target.request.face) carry_face(scene_, now_, settings_.threads);
}

}  // namespace condyle
