#pragma once

#include <functional>
#include <memory>

#include "render/recording/muscle_bellies.h"
#include "render/window/view/view_state.h"
#include "sim/session/job.h"
#include "sim/session/session_patient.h"

namespace condyle {

/// Bellies of the muscles that a window shows, shaped in the background when they are first shown
/// and after each edit of the plan.
class ShownBellies {
 public:
  /// `retired`, `notify`: as of Job.
  ShownBellies(RetiredWork& retired, std::function<void()> notify)
      : job_(retired, std::move(notify)) {}

  /// Those to draw, without waiting: until the patient's are ready the last ones, if these are of
  /// the same muscles. Null where none are ready and while the view shows no muscle.
  /// throws: what ended their shaping, once.
  std::shared_ptr<const MuscleBellies> of(const std::shared_ptr<const SessionPatient>& patient,
                                          const ViewState& view);

 private:
  std::shared_ptr<const Operated> shaped_for_;  // whose bellies are ready, or are being shaped
  std::shared_ptr<const MuscleBellies> ready_;
  Job<std::shared_ptr<const MuscleBellies>> job_;
};

}  // namespace condyle
