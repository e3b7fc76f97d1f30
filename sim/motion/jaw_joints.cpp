#include "sim/motion/jaw_joints.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/math/smooth_step.h"
#include "sim/motion/condylar_kinematics.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double default_bennett_deg = 7.5, default_side_shift_mm = 0.3;
constexpr double side_shift_length_mm = 1;

Vector3d needed(const Case& patient, const char* name) {
  const auto point = patient.landmarks.find(name);
  if (!point)
    throw InputError(fmt::format(
        "{}: the built-in motions need the landmark {}; {}", patient.name, name,
        patient.find(Role::mandible) ? "add it to the case's landmarks"
                                     : "the case has no mandible, which they would move"));
  return *point;
}

/// Rotation of X about an axis, rad.
double turn_about(const Vector3d& axis, const Pose& X) {
  return 2 * std::atan2(X.R.vec().dot(axis.normalized()), X.R.w());
}

}  // namespace

void JawJoints::set_condyles(const Case& patient, const MotionParameters& parameters) {
  incisor_ = needed(patient, "lower_incisal_point");
  articulator_ = parameters.bonwill_mm || parameters.balkwill_deg;
  const bool marked =
      patient.landmarks.find("left_condyle") && patient.landmarks.find("right_condyle");
  if (marked || !articulator_) {
    left_ = needed(patient, "left_condyle");
    right_ = needed(patient, "right_condyle");
    if (left_.x() - right_.x() < 20)
      throw InputError(
          fmt::format("{}: left_condyle (x {:.1f}) must lie at least 20 mm to the left (+x) of "
                      "right_condyle (x {:.1f})",
                      patient.name, left_.x(), right_.x()));
  }
  if (!articulator_) return;
  constexpr double default_bonwill_mm = 104, default_balkwill_deg = 26;
  const double side = parameters.bonwill_mm.value_or(marked ? bonwill_mm() : default_bonwill_mm);
  const double angle =
      parameters.balkwill_deg.value_or(marked ? balkwill_deg() : default_balkwill_deg) * degree;
  const double width = marked ? (left_ - right_).norm() : side;
  if (2 * side < 1.1 * width)
    throw InputError(
        fmt::format("Bonwill distance {:.1f} mm: too short for condyles that are {:.1f} mm apart",
                    side, width));
  const double height = std::sqrt(side * side - 0.25 * width * width);
  const Vector3d middle = incisor_ + height * Vector3d(0, std::cos(angle), std::sin(angle));
  left_ = middle + Vector3d(0.5 * width, 0, 0);
  right_ = middle - Vector3d(0.5 * width, 0, 0);
}

JawJoints::JawJoints(const Case& patient, const MotionParameters& parameters, JointReach reach,
                     int threads) {
  set_condyles(patient, parameters);
  closed_incisor_ = patient.X_CM_closed * incisor_;
  closed_theta_ = turn_about(left_ - right_, patient.X_CM_closed);
  bennett_slope_ = std::tan(parameters.bennett_deg.value_or(default_bennett_deg) * degree);
  side_shift_mm_ = parameters.side_shift_mm.value_or(default_side_shift_mm);
  // Condyles placed as in an articulator have no fossae.
  if (!articulator_) surfaces_ = JointSurfaces::find(patient);
  bool from_fossa = false, given = false;
  for (const JawSide which : {JawSide::left, JawSide::right}) {
    Side& joint = sides_[which == JawSide::left ? 0 : 1];
    const auto inclination =
        which == JawSide::left ? parameters.inclination_left_deg : parameters.inclination_right_deg;
    if (surfaces_) {
      joint.gap.seated_mm = parameters.disc_gap_mm.value_or(surfaces_->rest_gap_mm(which));
      joint.gap.front_mm =
          parameters.disc_gap_front_mm.value_or(std::min(joint.gap.seated_mm, usual_front_gap_mm));
    }
    if (inclination) {
      joint.path = inclined_path(*inclination, parameters.path_shape.value_or(1));
      given = true;
    } else if (surfaces_) {
      const double widest =
          reach == JointReach::aside ? 0.5 + side_shift_mm_ + 14 * bennett_slope_ : 0;
      joint.table.emplace(*surfaces_, which,
                          CondylarPathTable::Settings{.center = condyle(which),
                                                      .axis = (left_ - right_).normalized(),
                                                      .gap = joint.gap,
                                                      .widest_shift_mm = widest},
                          threads);
      from_fossa = true;
    } else if (patient.condylar_path && !articulator_) {
      joint.path = path_of_case(*patient.condylar_path);
    } else {
      joint.path = average_path();
    }
  }
  well_known_ = patient.condylar_path.has_value() && !articulator_;
  if (given)
    guide_ = from_fossa
                 ? "along a path of given inclination on one side, along the fossa on the other"
                 : "along a path of given inclination";
  else if (from_fossa)
    guide_ = "condyles keep the disc gap to the fossa";
  else if (patient.condylar_path && !articulator_)
    guide_ = "along the patient's own condylar path";
  else
    guide_ = "along an average condylar path, because no fossa was found";
}

double JawJoints::inferior_translation_mm(JawSide which, double forward_mm, double theta,
                                          double shift_mm) const {
  const Side& joint = side(which);
  return joint.table ? joint.table->inferior_translation_mm(forward_mm, theta, shift_mm)
                     : joint.path(std::max(forward_mm, 0.0));
}

double JawJoints::inclination_deg(JawSide which) const {
  constexpr double secant_mm = 5;
  return std::atan2(inferior_translation_mm(which, secant_mm), secant_mm) / degree;
}

double JawJoints::bennett_shift_mm(double left_mm, double right_mm) const {
  const double ahead = left_mm - right_mm, s = std::abs(ahead);
  const double medial =
      side_shift_mm_ * (1 - std::exp(-s / side_shift_length_mm)) + s * bennett_slope_;
  return ahead > 0 ? -medial : medial;
}

Pose JawJoints::pose(const JawInputs& in) const {
  const Vector3d across = left_ - right_, middle = 0.5 * (left_ + right_);
  const double width = across.norm();
  const double dy = across.y() - in.left_mm + in.right_mm;
  const double dz = across.z() -
                    inferior_translation_mm(JawSide::left, in.left_mm, in.theta, in.shift_mm) +
                    inferior_translation_mm(JawSide::right, in.right_mm, in.theta, in.shift_mm);
  // The intercondylar distance is constant: the orbiting condyle is where the inputs put it, and
  // the working condyle compensates for the foreshortening of an oblique jaw.
  const double dx = std::sqrt(std::max(width * width - dy * dy - dz * dz, 0.01 * width * width));
  const double ahead = in.left_mm - in.right_mm;
  const double side = (ahead > 0 ? 1 : -1) * smooth_step(0.5 * std::abs(ahead));
  const Vector3d now(dx, dy, dz);
  const Vector3d at(
      middle.x() + in.shift_mm + 0.5 * side * (across.x() - dx),
      middle.y() - 0.5 * (in.left_mm + in.right_mm),
      middle.z() -
          0.5 * (inferior_translation_mm(JawSide::left, in.left_mm, in.theta, in.shift_mm) +
                 inferior_translation_mm(JawSide::right, in.right_mm, in.theta, in.shift_mm)));
  const Eigen::Quaterniond slant = Eigen::Quaterniond::FromTwoVectors(across, now);
  const Eigen::Quaterniond R = (Eigen::AngleAxisd(in.theta, now.normalized()) * slant).normalized();
  return {R, at - R * middle};
}

double JawJoints::bonwill_mm() const {
  return 0.5 * ((left_ - incisor_).norm() + (right_ - incisor_).norm());
}

double JawJoints::balkwill_deg() const {
  const Vector3d up = 0.5 * (left_ + right_) - incisor_;
  return std::atan2(up.z(), std::hypot(up.x(), up.y())) / degree;
}

}  // namespace condyle
