#pragma once

#include <string>

#include "sim/dynamics/release_jaw.h"
#include "sim/session/session_motion.h"

namespace condyle {

/// A body that came to rest on bone.
struct ReleasedBody {
  Pose X_PB;          // its pose at rest, in its parent's frame
  std::string words;  // the result as a sentence
};

/// Releases a body from its pose in the frame, pushed with 1 N towards the nearest bone. `name`: of
/// the body, in the sentence. throws: InputError when it does not come to rest.
ReleasedBody release_body(const SessionPatient& patient, BodyId body, const std::string& name,
                          const FrameState& frame, int threads, const Progress& progress);

/// A jaw that was released, and its path to rest.
struct ReleasedJaw {
  JawRelease course;
  std::string words;
};

/// Releases the jaw from the bodies' poses. Its muscles are excited as the motion excites them
/// at `time_s`, or at their resting tone when the motion excites none. throws: InputError.
ReleasedJaw release_jaw(const SessionPatient& patient, const SessionMotion& motion, double time_s,
                        const BodyPoses& from, const SessionSettings& settings,
                        const Progress& progress);

}  // namespace condyle
