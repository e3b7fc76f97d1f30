#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/progress.h"
#include "sim/case/case.h"
#include "sim/contact/contact.h"
#include "sim/contact/seat.h"
#include "sim/frame/frame_state.h"
#include "sim/motion/motion.h"
#include "sim/tissue/tissue.h"

namespace condyle {

struct SimulatorSettings {
  double step_s = 1.0 / 120;  // fixed, independent of the recorded frame rate
  int threads = 2;            // results are bit-identical for any number
  bool tissue = true;         // simulate the soft tissue
  bool face = false;          // also carry the displayed face in every requested frame
  TissueSettings tissue_model;
  TissueBudget tissue_budget;
  ContactSettings contact;
};

/// Length of a muscle at rest, mm.
struct MuscleLengthChange {
  std::string muscle;
  double before_mm = 0, after_mm = 0;
};

/// The plan of the operation after which a scene shows its patient.
struct ScenePlan {
  std::string name, hash;
  std::vector<std::string> notes = {};
  std::vector<MuscleLengthChange> muscles = {};  // whose length the operation changes
  std::vector<Seat> seats = {};                  // of its grafts
};

/// Data that is constant while the jaw moves: the patient and the models built from it.
struct Scene {
  Case patient;
  ContactModel contacts;
  std::shared_ptr<const TissueModel> tissue;     // null without a face, or when not requested
  std::optional<ScenePlan> plan = std::nullopt;  // none: the patient as in its case
};

Scene make_scene(Case patient, const SimulatorSettings& settings = {},
                 const Progress& progress = {});

/// The scene of a patient that was edited from `before` (sim/case/edit_bodies.h): what depends on
/// the edit is rebuilt, the rest is reused. Bit-identical to make_scene(). `patient` is edited from
/// the case given to make_scene() or from before.patient; `settings` are the same.
Scene edited_scene(const Scene& before, Case patient, const SimulatorSettings& settings = {},
                   const Progress& progress = {});

/// The patient at rest, before any step.
FrameState rest_frame(const Scene& scene);

/// One step of the frame loop: contact, tissue, measures. The face is computed by `carry_face`.
FrameState step(const Scene& scene, const FrameState& previous, const StepInput& input,
                const SimulatorSettings& settings, TissueWarmStart& warm);

/// Computes the displayed face of a frame.
void carry_face(const Scene& scene, FrameState& frame, int threads = 1);

/// Plays a motion in fixed steps and returns the state at any later time.
class Playback {
 public:
  /// The scene must outlive the playback. Recorded motion is not altered by contact unless
  /// requested. `X_PB_target`: constant targets of bodies that the motion does not drive.
  Playback(const Scene& scene, Motion motion, const SimulatorSettings& settings,
           bool respect_contact = false, std::vector<Pose> X_PB_target = {});

  /// State at `time_s`, which must not be earlier than in the previous call. Times between two
  /// steps are computed by an additional step that does not enter the sequence, so queries do not
  /// affect later states.
  FrameState at(double time_s);

  const Motion& motion() const { return motion_; }

 private:
  FrameState step_to(double time_s, const FrameState& from, TissueWarmStart& warm) const;

  const Scene& scene_;
  Motion motion_;
  SimulatorSettings settings_;
  bool obey_contact_;
  std::vector<Pose> X_PB_target_;
  long step_ = 0;
  TissueWarmStart warm_;
  FrameState now_;  // after step_ fixed steps
};

}  // namespace condyle
