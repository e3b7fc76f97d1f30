#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "engine/math/pose.h"
#include "sim/case/landmarks.h"
#include "sim/plan/clinical_frame.h"

namespace condyle {

constexpr double max_move_mm = 100;
constexpr double max_turn_deg = 60;

/// A segment's move from the uncut rest in the words of surgeons: first the rotations about a named
/// point, then the translation of that point. Zero is no move.
struct ClinicalMove {
  std::string about = {};  // landmark, or "centroid"; empty: the default of the segment
  double left_mm = 0;      // negative: to the patient's right
  double forward_mm = 0;   // advance; negative: set back
  double up_mm = 0;        // impact; negative: down-graft, extrude
  // Right-hand rotations about left, back and up, which stay fixed: roll first, then pitch, then
  // yaw.
  double roll_deg = 0;   // cant, about the sagittal axis: the left side goes down
  double pitch_deg = 0;  // about the transverse axis, clockwise seen from the patient's right:
                         // front down, back up, chin back
  double yaw_deg = 0;    // about the vertical axis: the front goes to the patient's left

  bool operator==(const ClinicalMove&) const = default;
};

/// The name of the point of a move: `about`, else upper_incisal_point for the segment "maxilla",
/// pogonion for "chin", "centroid" for any other.
std::string point_name(const ClinicalMove& move, std::string_view segment);

/// That point at rest. throws: InputError naming the landmark that the case lacks.
Eigen::Vector3d point_of(const ClinicalMove& move, std::string_view segment,
                         const Landmarks& landmarks, const Eigen::Vector3d& centroid);

/// throws: InputError for a value that is not finite, or a move by more than max_move_mm or
/// max_turn_deg, named with its value.
void check_move(const ClinicalMove& move);
/// The same for a pose, with the displacement of `point`.
void check_move(const Pose& X_CS, const Eigen::Vector3d& point);
/// The rotation alone, where no point of the segment is known; the translation must be finite.
void check_rotation(const Pose& X_CS);

/// X_CS of a segment from the uncut rest to the planned position. throws: InputError as
/// check_move().
Pose move_pose(const ClinicalMove& move, const ClinicalFrame& frame, const Eigen::Vector3d& point);

/// The move about `point` that has this pose; move_pose() of it is the pose again, up to rounding.
ClinicalMove clinical_move(const Pose& X_CS, const ClinicalFrame& frame,
                           const Eigen::Vector3d& point, std::string about = "");

/// The same move with the pitch by which `second`, a point of the segment at rest, rises by
/// `second_up_mm` (negative: falls): "U1 forward 4, up 2, PNS up 4".
/// throws: InputError if the points lie above each other, or no pitch within max_turn_deg does it.
ClinicalMove with_height(ClinicalMove move, const ClinicalFrame& frame,
                         const Eigen::Vector3d& point, const Eigen::Vector3d& second,
                         double second_up_mm);

/// A number with its direction, rounded: "4.0 forward", "0.0".
std::string in_words(double value, const char* positive, const char* negative, int digits = 1);

/// "left 1.0, forward 4.0, up 2.0 mm; pitch 2.2 degrees, front down": omits what rounds to zero.
std::string move_words(const ClinicalMove& move);

}  // namespace condyle
