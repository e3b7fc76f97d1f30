#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "sim/case/landmarks.h"

namespace condyle {

/// What is level: the Frankfort plane through porions and orbitales, or the natural head position.
enum class Horizontal { frankfort, natural_head_position };

/// The reference that a plan stores.
struct HeadReference {
  Horizontal horizontal = Horizontal::frankfort;
  /// Natural head position N from the case's axes: v_N = R_NC v_C. The default takes the case's z
  /// axis as up.
  Eigen::Quaterniond R_NC = Eigen::Quaterniond::Identity();

  bool operator==(const HeadReference& other) const {
    return horizontal == other.horizontal && R_NC.coeffs() == other.R_NC.coeffs();
  }
};

/// "frankfort", "natural_head_position".
std::string horizontal_name(Horizontal horizontal);

/// The patient's own directions in the case's frame: unit vectors, (left, back, up) right-handed as
/// the axes of DICOM LPS.
struct ClinicalFrame {
  Eigen::Vector3d left = Eigen::Vector3d::UnitX();
  Eigen::Vector3d back = Eigen::Vector3d::UnitY();
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // a point of the midsagittal plane
  std::vector<std::string> notes = {};               // landmarks that replaced missing ones

  Eigen::Vector3d right() const { return -left; }
  Eigen::Vector3d forward() const { return -back; }
  Eigen::Vector3d down() const { return -up; }
  /// Components of a displacement: left, back, up.
  Eigen::Vector3d components(const Eigen::Vector3d& v) const {
    return {left.dot(v), back.dot(v), up.dot(v)};
  }
  /// The displacement with these components.
  Eigen::Vector3d vector(const Eigen::Vector3d& components) const {
    return left * components.x() + back * components.y() + up * components.z();
  }
};

/// The directions of a patient in LPS. The midsagittal plane contains nasion, basion and the
/// midpoint of the porions, for which glabella, sella and the midpoint of the condyles stand in.
/// Frankfort: left is normal to that plane, back runs from the orbitales to the porions, projected
/// on it. Natural head position: up is given, and left is the normal made level; without these
/// landmarks it is the left of the given rotation.
/// throws: InputError naming the missing landmark, landmarks of exchanged sides, or points in line.
ClinicalFrame clinical_frame(const Landmarks& landmarks, const HeadReference& reference = {});

}  // namespace condyle
