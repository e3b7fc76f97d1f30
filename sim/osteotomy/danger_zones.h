#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/cut/cut.h"
#include "sim/case/case.h"
#include "sim/plan/plan_zone.h"

namespace condyle {

/// Distances below which a cut is warned of, and stopped.
struct DangerMargin {
  double warn_mm = 0, stop_mm = 0;
};
/// Textbook values. `interdental`: of a root from a cut that runs between two teeth on purpose: 1
/// mm of bone on each, at the very least half of it.
struct DangerMargins {
  DangerMargin tooth{5, 3}, canal{2, 0}, foramen{5, 3}, other{5, 3}, interdental{1, 0.5};

  const DangerMargin& of(ZoneKind kind) const;
};

/// A structure that a saw should keep away from: a tooth, a canal with its radius, the mouth of a
/// canal, or one of the user's own.
struct DangerZone {
  std::string name;  // "tooth 36", "left mandibular canal", "left mental foramen"
  ZoneKind kind = ZoneKind::tooth;
  std::vector<Eigen::Vector3d> points;  // of its surface or centre line, at most 0.5 mm apart
  double radius_mm = 0;
  DangerMargin margin = {};
  std::vector<Eigen::Vector3d> root = {};  // of a tooth, see split_tooth()
  TriMesh solid = {};  // of an own zone with a closed surface: cuts may also lie inside it
};

/// Mark of the first wall of a cut that runs between two teeth on purpose, see Region::above();
/// larger ones count as such, too.
constexpr int interdental_wall = 1000;

enum class DangerLevel { clear, warn, stop };

/// The least distance of cut faces from a zone; negative where they enter it.
struct DangerFinding {
  std::string zone;
  ZoneKind kind = ZoneKind::tooth;
  double distance_mm = 0;
  DangerMargin margin = {};
  bool interdental = false;                      // of a cut between two teeth
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  // on the cut face
  DangerLevel level = DangerLevel::clear;
};

/// Zones of a bone: the separate teeth and canals of its body, and foramina among the landmarks for
/// which it is the nearest bone of that jaw. `roots`: finds those of the teeth, which cuts between
/// teeth are measured from.
std::vector<DangerZone> danger_zones(const Case& patient, const Part& bone, bool roots = false,
                                     const DangerMargins& margins = {});

/// A zone of the user's own, which counts for every bone.
DangerZone own_zone(const PlanZone& zone, const DangerMargins& margins = {});

/// Zones nearer to the cut faces of the pieces than `reach_mm`, nearest first.
std::vector<DangerFinding> check_danger_zones(const std::vector<DangerZone>& zones,
                                              const std::vector<Piece>& pieces,
                                              const DangerMargins& margins = {},
                                              double reach_mm = 15);

/// "tooth 36: 2.1 mm from the cut, less than 3 mm", for people.
std::string danger_text(const DangerFinding& finding);

}  // namespace condyle
