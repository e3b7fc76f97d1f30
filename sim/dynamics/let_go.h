#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/case/case.h"
#include "sim/dynamics/rest.h"
#include "sim/frame/body_poses.h"

namespace condyle {

struct LetGoSettings {
  Eigen::Vector3d push_N = Eigen::Vector3d::Zero();  // of the hand, at the part's middle, cranium
  double friction = 0.3;                             // Coulomb coefficient
  double reach_mm = 15;    // surfaces farther from the part's box at the start are not looked at
  double speed_mm_s = 40;  // at which the hand brings it down
  RestSettings rest = {};
};

/// One place where the part lies on another.
struct LetGoContact {
  int part = 0;                                       // the other
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // cranium
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, out of the other part
  double gap_mm = 0;                                  // negative: depth
  double push_N = 0;
};

struct LetGo {
  BodyPoses poses;  // with the part where it came to rest
  Rest rest;
  std::vector<LetGoContact> contacts;
};

/// Lets a free part go from a pose under a push: it comes down on the bone beneath, turns and
/// slides until it lies still. All other parts stay where they are. The hand that pushes has
/// inertia and yields slowly, so that it settles without a bump. Same bits for any thread count.
/// throws: InputError when the part is not a free closed surface, nothing lies within reach, or the
/// push is zero or not finite.
LetGo let_go(const Case& patient, std::size_t part, const BodyPoses& from,
             const LetGoSettings& settings, int threads = 1);

}  // namespace condyle
