#include "sim/dynamics/jaw_let_go.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "sim/dynamics/bite_plane.h"
#include "sim/dynamics/excitation_finder.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double radius_mm = 50;        // of a jaw
constexpr std::size_t told_steps = 25;  // from one report of progress to the next
constexpr double tone_share = 0.3;      // of the work, that the tone takes to find

/// Keeps what is told of a piece of the work at its share of the whole.
Progress at_share(const Progress& progress, double share) {
  return [&progress, share](std::string_view, double) { report(progress, "letting go", share); };
}

[[noreturn]] void torn_off(const Case& patient) {
  throw InputError(patient.name +
                   ": the muscles would tear the jaw off; let it go nearer to its joints, or "
                   "excite less");
}

bool has_teeth(const Case& patient) {
  const Part *upper = patient.find(Role::upper_teeth), *lower = patient.find(Role::lower_teeth);
  return upper && lower && !upper->mesh.empty() && !lower->mesh.empty();
}

/// Excitations that hold the mandible still at a pose, as well as muscles can.
std::vector<double> holding_tone(const Case& patient, const Pose& X_CM,
                                 const MuscleJawSettings& settings, int threads,
                                 const Progress& progress) {
  constexpr double found_after_s = 0.4, mean_of_s = 0.1;
  MuscleJawSettings there = settings;
  there.X_CM = X_CM;
  MuscleJaw jaw(patient, there, threads, at_share(progress, 0));
  const ExcitationFinderSettings finding;
  ExcitationFinder finder(patient, jaw, finding);
  const long steps = std::lround(finding.hold_s / jaw.step_s()),
             holds = std::lround(found_after_s / finding.hold_s),
             counted = std::lround(mean_of_s / finding.hold_s);
  std::vector<double> tone(jaw.muscles().size(), 0.0);
  for (long hold = 0; hold < holds; ++hold) {
    report(progress, "letting go",
           tone_share * static_cast<double>(hold) / static_cast<double>(holds));
    const std::vector<double> now = finder.find(jaw, X_CM, X_CM);
    for (long k = 0; k < steps; ++k)
      if (!jaw.step(now, threads)) torn_off(patient);
    if (hold < holds - counted) continue;
    for (std::size_t m = 0; m < tone.size(); ++m) tone[m] += now[m] / static_cast<double>(counted);
  }
  return tone;
}

/// How far the condyles are from where they may be: the places they have on their paths.
double out_of_joint_mm(const Case& patient, const Pose& X_CM) {
  constexpr double path_mm = 20;  // that condyles go to and fro
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

/// Where all is when the jaw has taken along what it carries.
BodyPoses carried_along(const Case& patient, const BodyPoses& from, const Pose& X_CM) {
  BodyPoses now{X_CM, from.X_CF};
  const auto free = free_parts(patient.parts);
  for (std::size_t f = 0; f < now.X_CF.size(); ++f)
    if (patient.parts[free[f]].carrier == Body::mandible)
      now.X_CF[f] = X_CM * from.X_CM.inverse() * from.X_CF[f];
  return now;
}

bool lies_on_flat_bite(const BitePlane& bite, const Pose& X_CM) {
  constexpr double seated_mm = 0.05;
  return std::min((X_CM * bite.left - bite.left).dot(bite.normal),
                  (X_CM * bite.right - bite.right).dot(bite.normal)) < seated_mm;
}

/// What the jaw lies on in the end, and how hard on its teeth.
void find_support(const Case& patient, const MuscleJaw& jaw, bool teeth, JawLetGo& course) {
  if (!teeth && lies_on_flat_bite(bite_plane(patient), jaw.pose()))
    course.lies_on = JawLetGo::On::flat_bite;
  for (const RigidContact& contact : jaw.world().contacts())
    if (contact.pair == jaw.jaw().bite)
      course.bite_N += contact.push_N;
    else if (course.lies_on == JawLetGo::On::nothing && contact.push_N > 0)
      course.lies_on = JawLetGo::On::bone;
  if (course.bite_N > 0) course.lies_on = JawLetGo::On::teeth;
}

/// Where the jaw with what it carries gets to from a pose without lying in bone.
ContactModel::Slide slid_out(const Case& patient, const ContactModel& contacts,
                             const BodyPoses& from, int threads) {
  ContactModel::Wanted wanted{.X_CM = from.X_CM, .X_BF = {}};
  for (const std::size_t part : free_parts(patient.parts)) {
    const bool carried = patient.parts[part].carrier == Body::mandible;
    wanted.X_BF.push_back((carried ? from.X_CM : Pose{}).inverse() *
                          pose_of(patient.parts, part, from));
  }
  return contacts.slide(from, wanted, nullptr, threads);
}

}  // namespace

JawLetGo let_go_jaw(const Case& patient, const ContactModel& contacts, const BodyPoses& from,
                    const JawLetGoSettings& settings, int threads, const Progress& progress) {
  if (const double off = out_of_joint_mm(patient, from.X_CM); off > settings.reach_mm)
    throw InputError(
        fmt::format("{}: a condyle is {:.0f} mm out of its joint, farther than ligaments reach "
                    "({:.0f} mm); bring it nearer before letting it go",
                    patient.name, off, settings.reach_mm));
  MuscleMotionSettings muscles = settings.muscles;
  muscles.bolus = {};
  muscles.hyoid = "fixed";
  muscles.teeth = muscles.teeth && has_teeth(patient);
  MuscleJawSettings how = jaw_settings(muscles);
  std::vector<double> excitations;
  if (settings.excitations.empty())
    excitations = holding_tone(patient, settings.X_CM_rest, how, threads, progress);
  how.X_CM = from.X_CM;
  how.bones = from;
  MuscleJaw jaw(patient, how, threads, at_share(progress, tone_share));
  if (excitations.empty())
    for (const Muscle& muscle : jaw.muscles()) {
      const auto told = settings.excitations.find(muscle.name);
      excitations.push_back(told == settings.excitations.end() ? 0 : told->second);
    }

  JawLetGo course{.step_s = jaw.step_s(), .X_CM = {from.X_CM}, .rest = {}};
  double still_s = 0;
  while (course.rest.seconds < settings.rest.longest_s && still_s < settings.rest.still_for_s) {
    if (course.X_CM.size() % told_steps == 1)
      report(progress, "letting go",
             tone_share + (1 - tone_share) * course.rest.seconds / settings.rest.longest_s);
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
  report(progress, "letting go", 1);
  const BodyPoses end = carried_along(patient, from, jaw.pose());
  const auto depth = [](const ContactSet& set) { return set.max_penetration_mm(); };
  course.rest.depth_mm = depth(contacts.find(end, nullptr, threads));
  if (course.rest.depth_mm > jaw_rest_depth_mm) {
    const ContactModel::Slide out = slid_out(patient, contacts, end, threads);
    course.X_CM.push_back(out.at.X_CM);
    if (course.lies_on == JawLetGo::On::nothing) course.lies_on = JawLetGo::On::bone;
    course.rest.depth_mm = depth(out.contacts);
  }
  course.rest.reached &= course.rest.depth_mm <= jaw_rest_depth_mm;
  return course;
}

}  // namespace condyle
