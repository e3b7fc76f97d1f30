#include "sim/dynamics/release_jaw.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "sim/dynamics/bite_plane.h"
#include "sim/dynamics/excitation_finder.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double radius_mm = 50;                // of a jaw
constexpr std::size_t report_every_steps = 25;  // steps between reports of progress
constexpr double tone_fraction = 0.3;           // fraction of the work for finding the tone

/// Reports a constant fraction of the whole while a part of the work is done.
Progress at_fraction(const Progress& progress, double fraction) {
  return
      [&progress, fraction](std::string_view, double) { report(progress, "releasing", fraction); };
}

[[noreturn]] void torn_off(const Case& patient) {
  throw InputError(patient.name +
                   ": the muscles would tear the jaw off; release it nearer to its joints, or "
                   "excite less");
}

bool has_teeth(const Case& patient) {
  const Part *upper = patient.teeth_of(patient.jaw.upper_arch),
             *lower = patient.teeth_of(patient.jaw.lower_arch);
  return upper && lower && !upper->mesh.empty() && !lower->mesh.empty();
}

/// Excitations that best hold the mandible at a pose.
std::vector<double> holding_tone(const Case& patient, const Pose& X_CM,
                                 const MuscleJawSettings& settings, int threads,
                                 const Progress& progress) {
  constexpr double found_after_s = 0.4, mean_of_s = 0.1;
  MuscleJawSettings there = settings;
  there.X_CM = X_CM;
  MuscleJaw jaw(patient, there, threads, at_fraction(progress, 0));
  const ExcitationFinderSettings finding;
  ExcitationFinder finder(patient, jaw, finding);
  const long steps = std::lround(finding.hold_s / jaw.step_s()),
             holds = std::lround(found_after_s / finding.hold_s),
             counted = std::lround(mean_of_s / finding.hold_s);
  std::vector<double> tone(jaw.muscles().size(), 0.0);
  for (long hold = 0; hold < holds; ++hold) {
    report(progress, "releasing",
           tone_fraction * static_cast<double>(hold) / static_cast<double>(holds));
    const std::vector<double> now = finder.find(jaw, X_CM, X_CM);
    for (long k = 0; k < steps; ++k)
      if (!jaw.step(now, threads)) torn_off(patient);
    if (hold < holds - counted) continue;
    for (std::size_t m = 0; m < tone.size(); ++m) tone[m] += now[m] / static_cast<double>(counted);
  }
  return tone;
}

/// Distance of the condyles from their paths.
double out_of_joint_mm(const Case& patient, const Pose& X_CM) {
  constexpr double path_mm = 20;  // travel of the condyles along them
  double farthest = 0;
  for (const char* name : {"left_condyle", "right_condyle"})
    if (const auto seat = patient.landmarks.find(name)) {
      const Vector3d off = X_CM * *seat - *seat;
      farthest = std::max(farthest, (off - Vector3d(0, std::clamp(off.y(), -path_mm, 0.0),
                                                    std::clamp(off.z(), -path_mm, 0.0)))
                                        .norm());
    }
  return farthest;
}

bool lies_on_flat_bite(const BitePlane& bite, const Pose& X_CM) {
  constexpr double seated_mm = 0.05;
  return std::min((X_CM * bite.left - bite.left).dot(bite.normal),
                  (X_CM * bite.right - bite.right).dot(bite.normal)) < seated_mm;
}

/// Contacts of the jaw at the end, and the force on its teeth.
void find_support(const Case& patient, const MuscleJaw& jaw, bool teeth, JawRelease& course) {
  if (!teeth && lies_on_flat_bite(bite_plane(patient), jaw.pose()))
    course.lies_on = JawRelease::On::flat_bite;
  for (const RigidContact& contact : jaw.world().contacts())
    if (contact.pair == jaw.jaw().bite)
      course.bite_N += contact.push_N;
    else if (course.lies_on == JawRelease::On::nothing && contact.push_N > 0)
      course.lies_on = JawRelease::On::bone;
  if (course.bite_N > 0) course.lies_on = JawRelease::On::teeth;
}

/// The pose that the jaw with its descendants reaches from a pose without lying in bone.
ContactModel::Slide slid_out(const Case& patient, const ContactModel& contacts,
                             const BodyPoses& from, int threads) {
  return contacts.slide(from, in_parents(patient.bodies, from), nullptr, threads);
}

}  // namespace

JawRelease release_jaw(const Case& patient, const ContactModel& contacts, const BodyPoses& given,
                       const JawReleaseSettings& settings, int threads, const Progress& progress) {
  const BodyPoses from = completed(patient.bodies, given);
  const Pose X_CM_start = from[patient.jaw.lower_arch];
  if (const double off = out_of_joint_mm(patient, X_CM_start); off > settings.reach_mm)
    throw InputError(
        fmt::format("{}: a condyle is {:.0f} mm out of its joint, farther than ligaments reach "
                    "({:.0f} mm); bring it nearer before releasing it",
                    patient.name, off, settings.reach_mm));
  MuscleMotionSettings muscles = settings.muscles;
  muscles.bolus = {};
  muscles.hyoid = "fixed";
  muscles.teeth = muscles.teeth && has_teeth(patient);
  MuscleJawSettings how = jaw_settings(muscles);
  std::vector<double> excitations;
  if (settings.excitations.empty())
    excitations = holding_tone(patient, settings.X_CM_rest, how, threads, progress);
  how.X_CM = X_CM_start;
  how.bones = from;
  MuscleJaw jaw(patient, how, threads, at_fraction(progress, tone_fraction));
  if (excitations.empty())
    for (const Muscle& muscle : jaw.muscles()) {
      const auto named = settings.excitations.find(muscle.name);
      excitations.push_back(named == settings.excitations.end() ? 0 : named->second);
    }

  JawRelease course{.step_s = jaw.step_s(), .X_CM = {X_CM_start}, .rest = {}};
  double still_s = 0;
  while (course.rest.seconds < settings.rest.longest_s && still_s < settings.rest.still_for_s) {
    if (course.X_CM.size() % report_every_steps == 1)
      report(progress, "releasing",
             tone_fraction + (1 - tone_fraction) * course.rest.seconds / settings.rest.longest_s);
    if (!jaw.step(excitations, threads)) torn_off(patient);
    course.rest.seconds += jaw.step_s();
    course.X_CM.push_back(jaw.pose());
    const RigidMotion& motion = jaw.motion();
    const bool still =
        motion.velocity.norm() + radius_mm * motion.spin.norm() < settings.rest.still_mm_s;
    still_s = still ? still_s + jaw.step_s() : 0;
  }
  course.rest.reached = still_s >= settings.rest.still_for_s;
  find_support(patient, jaw, muscles.teeth, course);
  report(progress, "releasing", 1);
  const BodyPoses end = with_jaw_at(patient.bodies, from, jaw.pose());
  const auto depth = [](const ContactSet& set) { return set.max_penetration_mm(); };
  course.rest.depth_mm = depth(contacts.find(end, nullptr, threads));
  if (course.rest.depth_mm > jaw_rest_depth_mm) {
    const ContactModel::Slide out = slid_out(patient, contacts, end, threads);
    course.X_CM.push_back(out.at[patient.jaw.lower_arch]);
    if (course.lies_on == JawRelease::On::nothing) course.lies_on = JawRelease::On::bone;
    course.rest.depth_mm = depth(out.contacts);
  }
  course.rest.reached &= course.rest.depth_mm <= jaw_rest_depth_mm;
  return course;
}

}  // namespace condyle
