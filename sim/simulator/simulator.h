#pragma once

#include <memory>

#include "engine/core/progress.h"
#include "sim/case/case.h"
#include "sim/contact/contact.h"
#include "sim/frame/frame_state.h"
#include "sim/motion/motion.h"
#include "sim/tissue/tissue.h"

namespace condyle {

struct SimulatorSettings {
  double step_s = 1.0 / 120;  // fixed, whatever is recorded
  int threads = 2;            // results have the same bits for any number
  bool tissue = true;         // let the soft tissue follow
  bool face = false;          // also carry the displayed face in every frame that is asked for
  TissueSettings tissue_model;
  TissueBudget tissue_budget;
  ContactSettings contact;
};

/// What stays the same while the jaw moves: the patient and the models built from it.
struct Scene {
  Case patient;
  ContactModel contacts;
  std::shared_ptr<const TissueModel> tissue;  // null without a face, or when it was not wanted
};

Scene make_scene(Case patient, const SimulatorSettings& settings = {},
                 const Progress& progress = {});

/// The patient at rest, before any step.
FrameState rest_frame(const Scene& scene);

/// One step of the frame loop: contact, tissue, measures. The face is left to `carry_face`.
FrameState step(const Scene& scene, const FrameState& previous, const StepInput& input,
                const SimulatorSettings& settings);

/// Fills the displayed face of a frame.
void carry_face(const Scene& scene, FrameState& frame, int threads = 1);

/// Plays a motion in fixed steps and tells the state at any later time.
class Playback {
 public:
  /// The scene must outlive the playback. Recorded motion is not altered by contact unless asked.
  /// `X_BF_wanted`: where free parts are wanted all the time (StepInput).
  Playback(const Scene& scene, Motion motion, const SimulatorSettings& settings,
           bool respect_contact = false, std::vector<Pose> X_BF_wanted = {});

  /// State at `time_s`, which must not be earlier than in the call before. Times between two steps
  /// are answered by one extra step that the sequence forgets: what is asked for changes nothing.
  FrameState at(double time_s);

  const Motion& motion() const { return motion_; }

 private:
  FrameState step_to(double time_s, const FrameState& from) const;

  const Scene& scene_;
  Motion motion_;
  SimulatorSettings settings_;
  bool obey_contact_;
  std::vector<Pose> X_BF_wanted_;
  long step_ = 0;
  FrameState now_;  // after step_ fixed steps
};

}  // namespace condyle
