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
  // That it is attached to, the cranium or the mandible; none: carried by the soft tissue.
  std::optional<BodyId> bone = {};
  // In the soft tissue: 0 at the skin, 1 at its inner side; none: where `at` lies.
  std::optional<double> depth = 0.5;
  double spread_mm = 0;  // radius of the tissue that it pulls, one standard deviation
};

/// How the tension depends on the length and the excitation.
enum class FaceMuscleLaw {
  bounded,  // rises from the shortest length at this excitation, up to excitation * limit_N
  hill,     // excitation * limit_N, by the active force-length curve
};

/// A muscle of facial expression: polylines that shorten together.
struct FaceMuscle {
  std::string name;  // unique: "left_zygomaticus_major"
  std::string kind;  // the same on both sides: "zygomaticus_major"
  // Greatest tension of all lines together, and of the bounded law the greatest shortening as a
  // fraction of the length at rest; in a case 0: those of its kind.
  double limit_N = 0, shortening = 0.2;
  FaceMuscleLaw law = FaceMuscleLaw::bounded;
  std::vector<std::vector<FaceMusclePoint>> lines;
};

}  // namespace condyle
