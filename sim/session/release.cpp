#include "sim/session/release.h"

#include <fmt/format.h>

#include <limits>

#include "engine/core/error.h"
#include "sim/dynamics/release_body.h"
#include "sim/motion/measure_pose.h"

namespace condyle {
namespace {

/// A force of 1 N from the body and its descendants towards the nearest other bone; down when no
/// bone is near.
Eigen::Vector3d push_toward_bone(const Case& patient, const FrameState& frame, BodyId body) {
  double nearest_mm = std::numeric_limits<double>::max();
  Eigen::Vector3d to_bone = -Eigen::Vector3d::UnitZ();
  const auto is_within = [&](int part) {
    return patient.bodies.is_within(patient.parts[static_cast<std::size_t>(part)].body, body);
  };
  for (const auto& pair : frame.contacts.pairs) {
    const bool first = is_within(pair.part_a);
    if (first == is_within(pair.part_b) || pair.distance_is_bound) continue;
    if (pair.touching || pair.distance_mm >= nearest_mm) continue;
    nearest_mm = pair.distance_mm;
    to_bone = first ? pair.witness_b - pair.witness_a : pair.witness_a - pair.witness_b;
  }
  return to_bone.norm() > 1e-9 ? to_bone.normalized() : -Eigen::Vector3d::UnitZ();
}

std::string end_of(const JawRelease& course, double opening_mm) {
  switch (course.lies_on) {
    case JawRelease::On::teeth:
      return fmt::format("lies on its teeth with {:.1f} N", course.bite_N);
    case JawRelease::On::flat_bite:
      return "lies on a flat bite";
    case JawRelease::On::bone:
      return fmt::format("lies on bone, {:.1f} mm open,", opening_mm);
    case JawRelease::On::nothing:
      break;
  }
  return fmt::format("hangs {:.1f} mm open", opening_mm);
}

}  // namespace

ReleasedBody release_body(const SessionPatient& patient, BodyId body, const std::string& name,
                          const FrameState& frame, int threads, const Progress& progress) {
  const Case& of = patient.scene.patient;
  ReleaseSettings settings;
  settings.push_N = push_toward_bone(of, frame, body);
  const Release settled = condyle::release_body(of, body, frame.poses, settings, threads, progress);
  if (!settled.rest.reached)
    throw InputError(of.bodies[body].name + ": did not come to rest; move it nearer to the bone");
  return {pose_in(of.bodies[body].parent, body, settled.poses),
          fmt::format("The {} lies still after {:.2f} s on {} place{}", name, settled.rest.seconds,
                      settled.contacts.size(), settled.contacts.size() == 1 ? "" : "s")};
}

ReleasedJaw release_jaw(const SessionPatient& patient, const SessionMotion& motion, double time_s,
                        const BodyPoses& from, const SessionSettings& settings,
                        const Progress& progress) {
  report(progress, "releasing", 0);
  const Case& of = patient.scene.patient;
  const int threads = settings.simulator.threads;
  JawReleaseSettings released{.muscles = settings.muscles,
                              .excitations = excitations_at(motion, time_s)};
  const bool by_tone = released.excitations.empty();
  if (by_tone) released.X_CM_rest = rest_position(motion.choice, patient, settings);
  JawRelease course =
      condyle::release_jaw(of, patient.scene.contacts, from, released, threads, progress);
  std::string words = fmt::format(
      "{} the jaw {} after {:.2f} s{}",
      by_tone ? "At its muscles' resting tone" : "Moved by its muscles",
      end_of(course, measure(of, with_jaw_at(of.bodies, course.X_CM.back())).opening_mm),
      course.rest.seconds,
      course.rest.reached ? ""
      : course.rest.depth_mm > jaw_rest_depth_mm
          ? fmt::format(", {:.2f} mm deep in bone", course.rest.depth_mm)
          : ", not still yet");
  return {std::move(course), std::move(words)};
}

}  // namespace condyle
