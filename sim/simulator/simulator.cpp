#include "sim/simulator/simulator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "engine/core/user_cache.h"
#include "sim/case/face_muscle_table.h"
#include "sim/frame/state_hash.h"
#include "sim/motion/closed_position.h"
#include "sim/motion/measure_pose.h"
#include "sim/muscles/default_face_muscles.h"
#include "sim/tissue/lips.h"
#include "sim/tissue/stored_tissue.h"

namespace condyle {

Scene make_scene(Case patient, const SimulatorSettings& settings, const Progress& progress) {
  report(progress, "building the collision models", 0.0);
  locate_closed_position(patient);
  ContactModel contacts(patient, settings.contact);
  std::shared_ptr<const TissueModel> tissue;
  if (settings.tissue) {
    part_lips(patient);
    report(progress, "building the soft tissue", 0.3);
    TissueSettings of_tissue = settings.tissue_model;
    of_tissue.threads = settings.threads;
    of_tissue.face_muscles = muscles_of_face(patient);
    tissue = stored_tissue(user_cache_folder(), patient, of_tissue, progress);
  }
  report(progress, "building the soft tissue", 1.0);
  return {std::move(patient), std::move(contacts), std::move(tissue)};
}

namespace {

bool same_mesh(const TriMesh& a, const TriMesh& b) {
  return a.vertices == b.vertices && a.triangles == b.triangles && a.colors == b.colors;
}

/// Whether the soft tissue is unchanged: it depends on the jaw's bodies only.
bool same_for_tissue(const Case& a, const Case& b) {
  const auto parts = [](const Case& patient) {
    std::vector<const Part*> list;
    for (const Part& part : patient.parts)
      if (!is_rigid(part.role) || part.body == patient.jaw.upper_arch ||
          part.body == patient.jaw.lower_arch)
        list.push_back(&part);
    return list;
  };
  const auto x = parts(a), y = parts(b);
  return a.jaw == b.jaw && a.landmarks.points == b.landmarks.points &&
         face_muscles_csv(a.face_muscles) == face_muscles_csv(b.face_muscles) &&
         std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const Part* p, const Part* q) {
           return p->name == q->name && p->role == q->role && p->body == q->body &&
                  same_mesh(p->mesh, q->mesh);
         });
}

}  // namespace

Scene edited_scene(const Scene& before, Case patient, const SimulatorSettings& settings,
                   const Progress& progress) {
  report(progress, "building the collision models", 0.0);
  locate_closed_position(patient);
  ContactModel contacts(patient, settings.contact, &before.contacts);
  std::shared_ptr<const TissueModel> tissue;
  if (settings.tissue) {
    // The lips of the face of an earlier scene have been separated already.
    const Part *face = patient.find(Role::face), *parted = before.patient.find(Role::face);
    if (!(before.tissue && face && parted && same_mesh(face->mesh, parted->mesh)))
      part_lips(patient);
    report(progress, "building the soft tissue", 0.3);
    TissueSettings of_tissue = settings.tissue_model;
    of_tissue.threads = settings.threads;
    of_tissue.face_muscles = muscles_of_face(patient);
    const bool unchanged = before.tissue && same_for_tissue(before.patient, patient);
    tissue = unchanged ? before.tissue
                       : stored_tissue(user_cache_folder(), patient, of_tissue, progress);
  }
  report(progress, "building the soft tissue", 1.0);
  return {std::move(patient), std::move(contacts), std::move(tissue), before.plan};
}

FrameState rest_frame(const Scene& scene) {
  FrameState frame;
  frame.X_PB_target.resize(scene.patient.bodies.bodies().size());
  frame.poses = completed(scene.patient.bodies, {});
  frame.contacts = scene.contacts.at_rest();
  if (scene.tissue) frame.tissue = rest_tissue(*scene.tissue);
  frame.measures = measure(scene.patient, frame.poses);
  frame.state_hash = state_hash(frame);
  return frame;
}

FrameState step(const Scene& scene, const FrameState& previous, const StepInput& input,
                const SimulatorSettings& settings, TissueWarmStart& warm) {
  FrameState now;
  now.time_s = input.time_s;
  now.X_PB_target = input.X_PB_target;
  now.X_PB_target.resize(scene.patient.bodies.bodies().size());
  now.lids = input.excitation.closure();
  {
    const StageTimer timer(now.times, Stage::contact);
    if (input.obey_contact) {
      auto slide = scene.contacts.slide(previous.poses, input.X_PB_target, &previous.contacts,
                                        settings.threads, input.bound_far);
      now.poses = std::move(slide.at);
      now.stopped = slide.stopped;
      now.contacts = std::move(slide.contacts);
    } else {
      now.poses = placed(scene.patient.bodies, input.X_PB_target);
      now.contacts = scene.contacts.find(now.poses, &previous.contacts, settings.threads);
    }
  }
  if (scene.tissue && !settings.tissue) {
    now.tissue = previous.tissue;  // not requested
  } else if (scene.tissue) {
    const StageTimer timer(now.times, Stage::tissue);
    TissueBudget budget = settings.tissue_budget;
    budget.threads = settings.threads;
    now.tissue = solve_tissue(*scene.tissue, previous.tissue, now.poses.X_CB, budget, warm,
                              input.excitation.muscles);
  }
  {
    const StageTimer timer(now.times, Stage::measures);
    now.measures = measure(scene.patient, now.poses);
    now.state_hash = state_hash(now);
  }
  return now;
}

void carry_face(const Scene& scene, FrameState& frame, int threads) {
  if (!scene.tissue) return;
  const StageTimer timer(frame.times, Stage::face);
  deform_face(*scene.tissue, frame.tissue, frame.face, threads);
  frame.state_hash = state_hash(frame);
}

Playback::Playback(const Scene& scene, Motion motion, const SimulatorSettings& settings,
                   bool respect_contact, std::vector<Pose> X_PB_target)
    : scene_(scene),
      motion_(std::move(motion)),
      settings_(settings),
      obey_contact_(respect_contact || !motion_.recorded),
      X_PB_target_(std::move(X_PB_target)),
      now_(step_to(0, rest_frame(scene), warm_)) {}

FrameState Playback::step_to(double time_s, const FrameState& from, TissueWarmStart& warm) const {
  StageTimes motion_time;
  StepInput input{.time_s = time_s, .obey_contact = obey_contact_};
  {
    const StageTimer timer(motion_time, Stage::motion);
    input.X_PB_target = motion_target_poses(scene_.patient.bodies, motion_.target(time_s),
                                            motion_.pieces ? motion_.pieces(time_s) : X_PB_target_);
  }
  if (motion_.expression) input.excitation = motion_.expression(time_s);
  FrameState next = step(scene_, from, input, settings_, warm);
  if (motion_.muscles) {
    next.muscles = motion_.muscles(time_s);
    next.state_hash = state_hash(next);
  }
  next.times[Stage::motion] = motion_time[Stage::motion];
  return next;
}

FrameState Playback::at(double time_s) {
  constexpr double same_time_s = 1e-9;
  assert(time_s >= static_cast<double>(step_) * settings_.step_s - same_time_s);
  while (static_cast<double>(step_ + 1) * settings_.step_s <= time_s + same_time_s) {
    ++step_;
    now_ = step_to(static_cast<double>(step_) * settings_.step_s, now_, warm_);
  }
  const bool on_step = std::abs(time_s - now_.time_s) <= same_time_s;
  TissueWarmStart warm = warm_;
  FrameState shown = on_step ? now_ : step_to(time_s, now_, warm);
  if (shown.time_s != time_s) {
    shown.time_s = time_s;
    shown.state_hash = state_hash(shown);
  }
  if (settings_.face) carry_face(scene_, shown, settings_.threads);
  return shown;
}

}  // namespace condyle
