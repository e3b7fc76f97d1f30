#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/cut/cut.h"
#include "sim/case/case.h"

namespace condyle {

/// A structure that a saw should keep away from: a tooth, a canal with its radius, or the mouth of
/// a canal.
struct DangerZone {
  enum class Kind { tooth, canal, foramen };
  std::string name;  // "tooth 36", "left mandibular canal", "left mental foramen"
  Kind kind = Kind::tooth;
  std::vector<Eigen::Vector3d> points;  // of its surface or centre line, at most 0.5 mm apart
  double radius_mm = 0;
};

/// Distances below which a cut is warned of, and stopped.
struct DangerMargin {
  double warn_mm = 0, stop_mm = 0;
};
/// Defaults: a tooth 5 and 3 mm, a canal 2 and
/// 0 mm, a foramen 5 and 3 mm. Textbook values, to be changed by the user.
struct DangerMargins {
  DangerMargin tooth{5, 3}, canal{2, 0}, foramen{5, 3};

  const DangerMargin& of(DangerZone::Kind kind) const;
};

enum class DangerLevel { clear, warn, stop };

/// The least distance of cut faces from a zone; negative where they enter a canal.
struct DangerFinding {
  std::string zone;
  DangerZone::Kind kind = DangerZone::Kind::tooth;
  double distance_mm = 0;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // on the cut face
  DangerLevel level = DangerLevel::clear;
};

/// All zones that a patient names: separate teeth, canals, and foramina among the landmarks.
std::vector<DangerZone> danger_zones(const Case& patient);

/// Zones nearer to the cut faces of the pieces than `reach_mm`, nearest first.
std::vector<DangerFinding> check_danger_zones(const std::vector<DangerZone>& zones,
                                              const std::vector<Piece>& pieces,
                                              const DangerMargins& margins = {},
                                              double reach_mm = 15);

/// "tooth 36: 2.1 mm from the cut, less than 3 mm", for people.
std::string danger_text(const DangerFinding& finding, const DangerMargins& margins = {});

}  // namespace condyle
