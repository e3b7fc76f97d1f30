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
  double reach_mm = 15;  // what lies farther off is not looked at; who goes farther is not at rest
  double speed_mm_s = 40;  // at which the hand brings it down
  RestSettings rest = {};
  std::vector<std::size_t> yielding = {};  // other free parts, which give way when they are pushed
};

/// One place where a part that was let go lies on another.
struct LetGoContact {
  int part = 0;                                       // the one it lies on
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // cranium
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, out of the other part
  double gap_mm = 0;                                  // negative: depth
  double push_N = 0;
  int lies = 0;  // the part that lies there
};

struct LetGo {
  BodyPoses poses;  // with the parts where they came to rest
  Rest rest;
  std::vector<LetGoContact> contacts;
};

/// Lets a free part go from a pose under a push: it comes down on the bone beneath, turns and
/// slides until it lies still. Parts that yield are pushed along, and push others in turn; all else
/// stays where it is. The hand that pushes has inertia and yields slowly, as does the soft tissue
/// about what is pushed along, so that they settle without a bump. Same bits for any thread count.
/// What is more than 0.1 mm deep in bone in the end, by the exact surfaces, is not at rest.
/// Throwing from the progress gives up.
/// throws: InputError when a part is not free, starts more than 1 mm deep in bone, nothing lies
/// within reach, or the push is zero or not finite.
LetGo let_go(const Case& patient, std::size_t part, const BodyPoses& from,
             const LetGoSettings& settings, int threads = 1, const Progress& progress = {});

}  // namespace condyle
