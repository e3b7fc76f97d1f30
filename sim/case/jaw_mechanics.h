#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>

#include "sim/case/condylar_path.h"

namespace condyle {

/// A bone as a rigid body, cranium's frame at rest.
struct BoneMechanics {
  double mass_kg = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();       // centre of mass, mm
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity();  // about the centre of mass, kg mm^2
  double drag_kg_s = 0;              // drag force per velocity: 1 kg/s = 0.001 N s/mm
  double turning_drag_kg_mm2_s = 0;  // drag torque per angular velocity
};

/// Mechanical data of a patient's jaw: masses, drag and condylar guide.
struct JawMechanics {
  BoneMechanics mandible;
  std::optional<BoneMechanics> hyoid;
  std::optional<CondylarPath> guide;  // of both condyles in muscle-driven motion
};

/// JSON: {"jaw": {mass_kg, com_mm, inertia_about_com_kg_mm2, frame_damping, rotary_damping},
/// "hyoid": {the same, inertia may be absent}, "tmj":
/// {"polyline_posterior_superior_offsets_mm_from_tmj_marker": [[back, up], ...]}}; other keys are
/// ignored. throws: InputError with file, key and value.
JawMechanics read_mechanics(const std::filesystem::path& file);

/// The data as JSON text with exact round trip.
std::string mechanics_json(const JawMechanics& mechanics);

}  // namespace condyle
