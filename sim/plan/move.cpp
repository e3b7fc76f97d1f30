#include "sim/plan/move.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "engine/core/error.h"
#include "engine/core/units.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Least distance of two points along the sagittal from which their heights give a pitch.
constexpr double least_lever_mm = 5;

Eigen::Quaterniond rotation(const ClinicalMove& move, const ClinicalFrame& frame) {
  const Eigen::AngleAxisd roll(move.roll_deg * degree, frame.back);
  const Eigen::AngleAxisd pitch(move.pitch_deg * degree, frame.left);
  const Eigen::AngleAxisd yaw(move.yaw_deg * degree, frame.up);
  return (Eigen::Quaterniond(yaw) * Eigen::Quaterniond(pitch) * Eigen::Quaterniond(roll))
      .normalized();
}

void check_turn(double turn_deg) {
  if (!(turn_deg <= max_turn_deg))
    throw InputError(
        fmt::format("the move turns the segment by {:.1f} degrees; at most {:g} are "
                    "possible",
                    turn_deg, max_turn_deg));
}

void check_distance(double distance_mm) {
  if (!(distance_mm <= max_move_mm))
    throw InputError(
        fmt::format("the move displaces the segment by {:.1f} mm; at most {:g} are "
                    "possible",
                    distance_mm, max_move_mm));
}

void check_value(const char* name, double value, double most, const char* unit) {
  if (!(std::abs(value) <= most))
    throw InputError(fmt::format("{} is {:g} {}; expected a number from {:g} to {:g}", name, value,
                                 unit, -most, most));
}

}  // namespace

std::string point_name(const ClinicalMove& move, std::string_view segment) {
  if (!move.about.empty()) return move.about;
  if (segment == "maxilla") return "upper_incisal_point";
  if (segment == "chin") return "pogonion";
  return "centroid";
}

Vector3d point_of(const ClinicalMove& move, std::string_view segment, const Landmarks& landmarks,
                  const Vector3d& centroid) {
  const std::string name = point_name(move, segment);
  if (name == "centroid") return centroid;
  if (const auto found = landmarks.find(name)) return *found;
  throw InputError(fmt::format(
      "{} moves about {}, a landmark that the case lacks; name another point, or \"centroid\"",
      segment, name));
}

void check_move(const ClinicalMove& move) {
  check_value("left_mm", move.left_mm, max_move_mm, "mm");
  check_value("forward_mm", move.forward_mm, max_move_mm, "mm");
  check_value("up_mm", move.up_mm, max_move_mm, "mm");
  check_value("roll_deg", move.roll_deg, max_turn_deg, "degrees");
  check_value("pitch_deg", move.pitch_deg, max_turn_deg, "degrees");
  check_value("yaw_deg", move.yaw_deg, max_turn_deg, "degrees");
  check_distance(Vector3d(move.left_mm, move.forward_mm, move.up_mm).norm());
  // The axes of the frame do not matter to the angle of the rotation.
  const double turn = rotation_angle({rotation(move, {}), Vector3d::Zero()}) * degrees_per_radian;
  check_turn(turn - 1e-9);  // 60 degrees about one axis are exact only up to rounding
}

void check_rotation(const Pose& X_CS) {
  if (!X_CS.R.coeffs().allFinite() || !X_CS.t.allFinite())
    throw InputError("the pose is not finite");
  if (std::abs(X_CS.R.norm() - 1) > 1e-6)
    throw InputError(fmt::format("the rotation has the length {:g}; a unit quaternion is required",
                                 X_CS.R.norm()));
  check_turn(rotation_angle(X_CS) * degrees_per_radian - 1e-9);
}

void check_move(const Pose& X_CS, const Vector3d& point) {
  check_rotation(X_CS);
  check_distance((X_CS * point - point).norm());
}

Pose move_pose(const ClinicalMove& move, const ClinicalFrame& frame, const Vector3d& point) {
  check_move(move);
  const Eigen::Quaterniond R = rotation(move, frame);
  const Vector3d shift = frame.vector({move.left_mm, -move.forward_mm, move.up_mm});
  return {R, shift + (point - R * point)};
}

ClinicalMove clinical_move(const Pose& X_CS, const ClinicalFrame& frame, const Vector3d& point,
                           std::string about) {
  Eigen::Matrix3d axes;
  axes << frame.left, frame.back, frame.up;
  const Eigen::Matrix3d R = axes.transpose() * X_CS.R.toRotationMatrix() * axes;
  const Vector3d shift = frame.components(X_CS * point - point);
  ClinicalMove move{.about = std::move(about),
                    .left_mm = shift.x(),
                    .forward_mm = -shift.y(),
                    .up_mm = shift.z()};
  move.roll_deg = std::atan2(-R(2, 0), R(2, 2)) * degrees_per_radian;
  move.pitch_deg = std::atan2(R(2, 1), std::hypot(R(2, 0), R(2, 2))) * degrees_per_radian;
  move.yaw_deg = std::atan2(-R(0, 1), R(1, 1)) * degrees_per_radian;
  return move;
}

ClinicalMove with_height(ClinicalMove move, const ClinicalFrame& frame, const Vector3d& point,
                         const Vector3d& second, double second_up_mm) {
  check_value("the height of the second point", second_up_mm, max_move_mm, "mm");
  // Height of the second point above the first after roll and pitch: lever sin + rise cos. Yaw does
  // not change it.
  const Vector3d arm = frame.components(second - point);
  const double roll = move.roll_deg * degree;
  const double lever = arm.y();
  const double rise = std::cos(roll) * arm.z() - std::sin(roll) * arm.x();
  if (!(std::abs(lever) >= least_lever_mm))
    throw InputError(fmt::format(
        "the second point lies {:.1f} mm in front of or behind the point of the move; at least "
        "{:g} are required to find a pitch",
        std::abs(lever), least_lever_mm));
  const double target = arm.z() + second_up_mm - move.up_mm;
  const double reach = std::hypot(lever, rise);
  if (!(std::abs(target) <= reach))
    throw InputError(fmt::format(
        "no pitch moves the second point by {:g} mm: it would have to lie {:.1f} mm above or "
        "below the point of the move, from which it is {:.1f} mm away",
        second_up_mm, std::abs(target), reach));
  const double middle = std::atan2(lever, rise), half = std::acos(target / reach);
  double best = max_turn_deg + 1;
  for (const double angle : {middle - half, middle + half}) {
    const double pitch = std::remainder(angle, 2 * std::numbers::pi) * degrees_per_radian;
    if (std::abs(pitch) < std::abs(best)) best = pitch;
  }
  move.pitch_deg = best;
  check_move(move);
  return move;
}

std::string in_words(double value, const char* positive, const char* negative, int digits) {
  const std::string number = fmt::format("{:.{}f}", std::abs(value), digits);
  if (number.find_first_not_of("0.") == std::string::npos) return number;
  return number + " " + (value > 0 ? positive : negative);
}

std::string move_words(const ClinicalMove& move) {
  std::string shift, turn;
  const auto add_shift = [&](double value, const char* positive, const char* negative) {
    const std::string words = in_words(value, positive, negative);
    const auto space = words.find(' ');
    if (space == std::string::npos) return;
    shift += (shift.empty() ? "" : ", ") + words.substr(space + 1) + " " + words.substr(0, space);
  };
  const auto add_turn = [&](const char* name, double value, const char* positive,
                            const char* negative) {
    const std::string words = in_words(value, positive, negative);
    const auto space = words.find(' ');
    if (space == std::string::npos) return;
    turn += fmt::format("{}{} {} degrees, {}", turn.empty() ? "" : "; ", name,
                        words.substr(0, space), words.substr(space + 1));
  };
  add_shift(move.left_mm, "left", "right");
  add_shift(move.forward_mm, "forward", "back");
  add_shift(move.up_mm, "up", "down");
  add_turn("roll", move.roll_deg, "left side down", "right side down");
  add_turn("pitch", move.pitch_deg, "front down", "front up");
  add_turn("yaw", move.yaw_deg, "front to the left", "front to the right");
  if (!shift.empty()) shift += " mm";
  if (shift.empty() && turn.empty()) return "no move";
  return shift + (shift.empty() || turn.empty() ? "" : "; ") + turn;
}

}  // namespace condyle
