#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "sim/frame/body_tree.h"

namespace condyle {

/// A point of a muscle of the face at rest, in the cranium's frame, mm.
struct FaceMusclePoint {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  std::optional<BodyId> bone = {};  // that it is attached to; none: carried by the soft tissue
  double depth = 0.5;               // in the soft tissue: 0 at the skin, 1 at its inner side
  double spread_mm = 0;             // radius of the tissue that it pulls, one standard deviation
};

/// A muscle of facial expression: polylines that shorten together.
struct FaceMuscle {
  std::string name;         // unique: "left_zygomaticus_major"
  std::string kind;         // the same on both sides: "zygomaticus_major"
  double limit_N = 0;       // greatest tension of all lines together
  double shortening = 0.2;  // greatest, as a fraction of the length at rest
  std::vector<std::vector<FaceMusclePoint>> lines;
};

}  // namespace condyle
