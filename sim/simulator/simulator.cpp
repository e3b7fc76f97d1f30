#include "sim/simulator/simulator.h"

#include <cassert>
#include <cmath>
#include <utility>

#include "sim/motion/measures.h"
#include "sim/simulator/state_hash.h"
#include "sim/tissue/lips.h"

namespace condyle {

Scene make_scene(Case patient, const SimulatorSettings& settings, const Progress& progress) {
  report(progress, "building the collision models", 0.0);
  ContactModel contacts(patient, settings.contact);
  std::shared_ptr<const TissueModel> tissue;
  if (settings.tissue) {
    part_lips(patient);
    report(progress, "building the soft tissue", 0.3);
    TissueSettings of_tissue = settings.tissue_model;
    of_tissue.threads = settings.threads;
    tissue = build_tissue(patient, of_tissue, progress);
  }
  report(progress, "building the soft tissue", 1.0);
  return {std::move(patient), std::move(contacts), std::move(tissue)};
}

FrameState rest_frame(const Scene& scene) {
  FrameState frame;
  frame.contacts = scene.contacts.at_rest();
  if (scene.tissue) frame.tissue = rest_tissue(*scene.tissue);
  frame.measures = measure(scene.patient, frame.X_CM);
  frame.state_hash = state_hash(frame);
  return frame;
}

FrameState step(const Scene& scene, const FrameState& previous, const StepInput& input,
                const SimulatorSettings& settings) {
  FrameState now;
  now.time_s = input.time_s;
  now.X_CM_wanted = input.X_CM_wanted;
  {
    const StageTimer timer(now.times, Stage::contact);
    const ContactModel::Wanted wanted{input.X_CM_wanted, input.X_BF_wanted};
    BodyPoses at;
    if (input.obey_contact) {
      auto slide = scene.contacts.slide(previous.poses(), wanted, &previous.contacts,
                                        settings.threads, input.bound_far);
      at = std::move(slide.at);
      now.stopped = slide.stopped;
      now.contacts = std::move(slide.contacts);
    } else {
      at = scene.contacts.placed(wanted);
      now.contacts = scene.contacts.find(at, &previous.contacts, settings.threads);
    }
    now.X_CM = at.X_CM;
    now.X_CF = std::move(at.X_CF);
  }
  if (scene.tissue && !settings.tissue) {
    now.tissue = previous.tissue;  // nobody looks at it
  } else if (scene.tissue) {
    const StageTimer timer(now.times, Stage::tissue);
    TissueBudget budget = settings.tissue_budget;
    budget.threads = settings.threads;
    now.tissue = follow(*scene.tissue, previous.tissue, now.X_CM, budget);
  }
  {
    const StageTimer timer(now.times, Stage::measures);
    now.measures = measure(scene.patient, now.X_CM);
    now.state_hash = state_hash(now);
  }
  return now;
}

void carry_face(const Scene& scene, FrameState& frame, int threads) {
  if (!scene.tissue) return;
  const StageTimer timer(frame.times, Stage::face);
  deform_face(*scene.tissue, frame.tissue, frame.face, threads);
}

Playback::Playback(const Scene& scene, Motion motion, const SimulatorSettings& settings,
                   bool respect_contact, std::vector<Pose> X_BF_wanted)
    : scene_(scene),
      motion_(std::move(motion)),
      settings_(settings),
      obey_contact_(respect_contact || !motion_.recorded),
      X_BF_wanted_(std::move(X_BF_wanted)),
      now_(step_to(0, rest_frame(scene))) {}

FrameState Playback::step_to(double time_s, const FrameState& from) const {
  StageTimes motion_time;
  StepInput input{.time_s = time_s,
                  .X_CM_wanted = {},
                  .obey_contact = obey_contact_,
                  .X_BF_wanted = X_BF_wanted_};
  {
    const StageTimer timer(motion_time, Stage::motion);
    input.X_CM_wanted = motion_.wanted(time_s);
  }
  FrameState next = step(scene_, from, input, settings_);
  if (motion_.muscles) next.muscles = motion_.muscles(time_s);
  next.times[Stage::motion] = motion_time[Stage::motion];
  return next;
}

FrameState Playback::at(double time_s) {
  constexpr double same_time_s = 1e-9;
  assert(time_s >= static_cast<double>(step_) * settings_.step_s - same_time_s);
  while (static_cast<double>(step_ + 1) * settings_.step_s <= time_s + same_time_s) {
    ++step_;
    now_ = step_to(static_cast<double>(step_) * settings_.step_s, now_);
  }
  const bool on_step = std::abs(time_s - now_.time_s) <= same_time_s;
  FrameState shown = on_step ? now_ : step_to(time_s, now_);
  shown.time_s = time_s;
  if (settings_.face) carry_face(scene_, shown, settings_.threads);
  return shown;
}

}  // namespace condyle
