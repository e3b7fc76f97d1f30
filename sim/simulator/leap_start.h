#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "sim/simulator/live.h"

namespace condyle {

/// Where a step begins when what hands want leaps, as by undo, by putting back or by a typed
/// number: no way was shown on which the bodies could follow, and from where they are it may be
/// barred by what they have passed. What was asked before begins where it ended then; else the
/// mandible may begin where the motion had it, if from there it comes nearer and lies no deeper.
class LeapStart {
 public:
  /// Keeps the scene.
  LeapStart(const Scene& scene, int threads) : scene_(scene), threads_(threads) {}

  /// What is asked of the bodies in a step.
  struct Asked {
    LiveRequest request;
    std::optional<Pose> held_X_CM;  // of a hand that holds the mandible
    Pose X_CM;                      // of the hand, or the motion
    std::vector<Pose> X_BF;         // of each free part
  };
  /// Tells every step; `by_hand`: hands have moved since the last one. None: it begins where the
  /// bodies are.
  std::optional<BodyPoses> of(const Asked& asked, const FrameState& now, bool by_hand);
  /// Where a step that is not on its way to another ended.
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
  Pose followed_;  // the mandible's when it last followed the motion
};

/// Farther than steps of a motion go.
bool leaps(const Pose& from, const Pose& to);

}  // namespace condyle
