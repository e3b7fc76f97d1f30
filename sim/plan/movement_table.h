#pragma once

#include <Eigen/Core>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/frame/body_poses.h"
#include "sim/frame/body_tree.h"
#include "sim/plan/clinical_frame.h"

namespace condyle {

/// The body that carries each landmark.
using LandmarkOwners = std::map<std::string, BodyId>;

/// Owners of the landmarks of the table by the jaw's bodies: gonion and condyle move with the body
/// of the condyle on their side. A plan replaces those that a cut separates, such as pogonion.
LandmarkOwners default_landmark_owners(const JawBodies& jaw);

/// Landmarks moved with their owners; those without an owner stay.
Landmarks moved_landmarks(const Landmarks& rest, const LandmarkOwners& owners,
                          const BodyPoses& poses);

struct MovementRow {
  std::string label;     // "U1", "L6 right"
  std::string landmark;  // its name in the case
  double left_mm = 0, back_mm = 0, up_mm = 0;

  double distance_mm() const { return Eigen::Vector3d(left_mm, back_mm, up_mm).norm(); }
};

/// Rotation of a body from the uncut rest: as in ClinicalMove.
struct SegmentRotation {
  std::string body;
  double yaw_deg = 0, pitch_deg = 0, roll_deg = 0;
};

/// Of both arches, before and after: distance of the dental midline from the midsagittal plane
/// (positive to the left), and how much lower the left tooth is than the right one.
struct MidlineRow {
  std::string label;  // "upper midline", "cant U6"
  bool is_cant = false;
  double before_mm = 0, after_mm = 0;
};

/// What a planner reads: displacements of named landmarks from rest, rotations of bodies, midlines
/// and cants.
struct MovementTable {
  std::vector<MovementRow> rows;
  std::vector<SegmentRotation> rotations;
  std::vector<MidlineRow> midlines;
};

/// Rows for the landmarks that the case has and that have an owner; rotations of all bodies but
/// the cranium.
MovementTable movement_table(const Landmarks& rest, const ClinicalFrame& frame,
                             const BodyTree& bodies, const LandmarkOwners& owners,
                             const BodyPoses& poses);

/// Aligned text with directions in words: "4.0 forward".
std::string movement_text(const MovementTable& table);
nlohmann::ordered_json movement_json(const MovementTable& table);

}  // namespace condyle
