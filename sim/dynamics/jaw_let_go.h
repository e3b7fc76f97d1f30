#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/dynamics/muscle_motion.h"
#include "sim/dynamics/rest.h"

namespace condyle {

/// A jaw at rest is not deeper in bone, beyond any overlap that was there at rest: what contact
/// allows, and rounding.
constexpr double jaw_rest_depth_mm = 0.025;

struct JawLetGoSettings {
  MuscleMotionSettings muscles = {};  // of these the law, and whether crowns or a flat bite meet
  // By muscle, held all the time, others 0; empty: the tone that holds the jaw at X_CM_rest.
  std::map<std::string, double> excitations = {};
  Pose X_CM_rest = {};
  double reach_mm = 25;  // of what holds a condyle in its joint
  RestSettings rest = {.longest_s = 4, .still_mm_s = 0.5};
};

/// Its course.
struct JawLetGo {
  enum class On { nothing, teeth, flat_bite, bone };
  double step_s = 0;
  std::vector<Pose> X_CM;  // at each step, from where it was let go
  Rest rest;          // its teeth need not touch; deeper than contact allows, it is not at rest
  double bite_N = 0;  // between the teeth in the end
  On lies_on = On::nothing;
};

/// Lets the mandible go from where a hand has it: its joints draw the condyles onto their paths,
/// muscles and weight move it until it hangs still or lies on its teeth or on other bone. Free
/// parts stay with what carries them. Where its joints would leave it in bone it slides out in the
/// end. The hyoid is fixed. Without teeth of their own both jaws meet in a flat bite. Same bits for
/// any thread count. Throwing from the progress gives up.
/// throws: InputError when landmarks or muscles do not do, when a condyle is beyond the reach of
/// its joint, and where the muscles tear the jaw off.
JawLetGo let_go_jaw(const Case& patient, const ContactModel& contacts, const BodyPoses& from,
                    const JawLetGoSettings& settings, int threads = 1,
                    const Progress& progress = {});

}  // namespace condyle
