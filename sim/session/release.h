#pragma once

#include <string>

#include "sim/dynamics/release_jaw.h"
#include "sim/session/session_motion.h"

namespace condyle {

/// A body that came to rest on bone.
struct ReleasedBody {
  Pose X_PB;          // where it lies, in its parent's frame
  std::string words;  // what came of it, as a sentence
};

/// Releases a body from where the frame has it, pushed with 1 N towards the nearest bone. `name`:
/// of the body, in the sentence. throws: InputError when it does not come to rest.
ReleasedBody release_body(const SessionPatient& patient, BodyId body, const std::string& name,
                          const FrameState& frame, int threads, const Progress& progress);

/// A jaw that was released, and its course to where it rests.
struct ReleasedJaw {
  JawRelease course;
  std::string words;
};

/// Releases the jaw from where the bodies are. Its muscles are excited as the motion excites them
/// at `time_s`, or at their resting tone when the motion excites none. throws: InputError.
ReleasedJaw release_jaw(const SessionPatient& patient, const SessionMotion& motion, double time_s,
                        const BodyPoses& from, const SessionSettings& settings,
                        const Progress& progress);

}  // namespace condyle
