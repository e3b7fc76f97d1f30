#pragma once

#include <map>
#include <string>
#include <vector>

#include "sim/dynamics/muscle_motion.h"
#include "sim/dynamics/rest.h"

namespace condyle {

/// A jaw at rest is not deeper in bone than at the rest of the case: tolerance of contact, and
/// rounding.
constexpr double jaw_rest_depth_mm = 0.025;

struct JawReleaseSettings {
  // of these the law, and whether crowns or a flat bite are used
  MuscleMotionSettings muscles = {};
  // By muscle, constant, 0 for others; empty: the tone that holds the jaw at X_CM_rest.
  std::map<std::string, double> excitations = {};
  Pose X_CM_rest = {};
  double reach_mm = 25;  // of the ligaments that hold a condyle in its joint
  RestSettings rest = {.longest_s = 4, .still_mm_s = 0.5};
};

/// Its trajectory.
struct JawRelease {
  enum class On { nothing, teeth, flat_bite, bone };
  double step_s = 0;
  std::vector<Pose> X_CM;  // at each step, from the released pose
  Rest rest;          // its teeth need not touch; deeper than contact allows, it is not at rest
  double bite_N = 0;  // between the teeth at the end
  On lies_on = On::nothing;
};

/// Releases the mandible from a pose: its joints draw the condyles onto their paths, and muscles
/// and weight move it until it hangs at rest or lies on its teeth or on other bone. Other bodies
/// stay in their parents' frames. Where its joints would leave it in bone, it slides out at the
/// end. The hyoid is fixed. Without separate teeth both jaws meet in a flat bite. Bit-identical for
/// any thread count. An exception from `progress` cancels. throws: InputError when landmarks or
/// muscles are unsuitable, when a condyle is beyond the reach of its joint, and where the muscles
/// tear the jaw off.
JawRelease release_jaw(const Case& patient, const ContactModel& contacts, const BodyPoses& from,
                       const JawReleaseSettings& settings, int threads = 1,
                       const Progress& progress = {});

}  // namespace condyle
