#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "sim/simulator/live.h"

namespace condyle {

/// Start of a step whose target is discontinuous, as after undo, reset or a typed number: no path
/// was given for the bodies to follow, and obstacles they have passed may block them where they
/// are. A target requested before starts where that step ended; otherwise the bodies of a motion
/// may start at their pose in the motion, if that is nearer to the target and no deeper in contact.
class TeleportStart {
 public:
  /// The scene must outlive this.
  TeleportStart(const Scene& scene, int threads) : scene_(scene), threads_(threads) {}

  /// Targets of the bodies in a step.
  struct Asked {
    LiveRequest request;
    std::vector<Pose> X_PB;            // target of each body in its parent's frame
    std::vector<bool> follows_motion;  // of each body: the motion drives it and no hand holds it
  };
  /// Called at every step; `by_hand`: hands have moved since the last one. Returns none if the step
  /// starts from the present poses.
  std::optional<BodyPoses> of(const Asked& asked, const FrameState& now, bool by_hand);
  /// Records where a step ended that has reached its target.
  void ended(const Asked& asked, const FrameState& now);

 private:
  const BodyPoses* before(const Asked& asked) const;
  std::optional<BodyPoses> from_the_motion(const Asked& asked, const FrameState& now) const;

  static constexpr std::size_t most = 2000;
  struct Place {
    Asked asked;
    BodyPoses at;
  };
  const Scene& scene_;
  int threads_;
  std::deque<Place> places_;
  std::optional<Asked> last_;
  std::vector<Pose> followed_;  // X_PB of each body when it last followed the motion
};

/// Whether two poses are farther apart than successive steps of a motion.
bool is_teleport(const Pose& from, const Pose& to);

}  // namespace condyle
