#include "sim/motion/closed_position.h"

#include <fmt/core.h>

#include "engine/core/error.h"
#include "engine/core/units.h"
#include "sim/motion/bite_guide.h"
#include "sim/motion/jaw_joints.h"
#include "sim/motion/measure_pose.h"

namespace condyle {
namespace {

constexpr int threads = 2;
// Teeth that are closer than this are closed: segmented and decimated crowns are no more exact.
constexpr double closed_mm = 1.5;
constexpr double max_closing = 45 * degree;

/// Rotation that raises the lower incisal point by `opening_mm`.
double declared_theta(const Case& patient, const JawJoints& joints, double opening_mm) {
  const auto raised_mm = [&](double theta) {
    return joints.incisor({theta, 0, 0, 0}).z() - joints.incisor().z();
  };
  double low = -max_closing, high = 0;
  if (raised_mm(low) < opening_mm)
    throw InputError(fmt::format(
        "{}: scan_opening_mm {:.6g}: the jaw rises by {:.1f} mm when it closes by {:.0f} degrees",
        patient.name, opening_mm, raised_mm(low), max_closing / degree));
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (raised_mm(middle) < opening_mm ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

bool has_joints(const Case& patient) {
  constexpr double min_width_mm = 20;
  const auto left = patient.landmarks.find("left_condyle");
  const auto right = patient.landmarks.find("right_condyle");
  return left && right && patient.landmarks.find("lower_incisal_point") &&
         left->x() - right->x() >= min_width_mm;
}

}  // namespace

void locate_closed_position(Case& patient) {
  patient.X_CM_closed = {};
  if (!has_joints(patient) || patient.scan_opening_mm == 0.0) return;
  if (!patient.scan_opening_mm && teeth_apart_at_rest_mm(patient) <= closed_mm) return;
  const JawJoints joints(patient, {}, JointReach::straight, threads);
  const double theta = patient.scan_opening_mm
                           ? declared_theta(patient, joints, *patient.scan_opening_mm)
                           : BiteGuide(patient, joints, {}).bite_theta();
  if (theta != 0) patient.X_CM_closed = joints.pose({theta, 0, 0, 0});
}

void report_scan_opening(Case& patient) {
  locate_closed_position(patient);
  if (const Measures scan = measure(patient, {}); scan.opening_mm > 0)
    patient.notes.push_back(fmt::format(
        "the mouth was open by {:.1f} mm in the scan ({}): openings and rotations count "
        "from the closed position, with the condyles where they are in the scan",
        scan.opening_mm,
        patient.scan_opening_mm ? "declared"
                                : "found from the teeth; declare another with --scan-opening"));
}

}  // namespace condyle
