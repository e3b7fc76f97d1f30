#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/case/case.h"
#include "sim/dynamics/rest.h"
#include "sim/frame/body_poses.h"

namespace condyle {

struct ReleaseSettings {
  Eigen::Vector3d push_N = Eigen::Vector3d::Zero();  // of the hand, at the body's centre, cranium
  double friction = 0.3;                             // Coulomb coefficient
  double reach_mm = 15;    // range of obstacles; a body that moves farther is not at rest
  double speed_mm_s = 40;  // at which the hand moves it
  RestSettings rest = {};
  std::vector<BodyId> yielding = {};  // other bodies, which move when they are pushed
};

/// One contact of a released body on another, by their parts.
struct ReleaseContact {
  int part = 0;                                       // the part that supports it
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // cranium
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, out of the other part
  double gap_mm = 0;                                  // negative: depth
  double push_N = 0;
  int lies = 0;  // the part of the released body
};

struct Release {
  BodyPoses poses;  // with the released bodies at rest
  Rest rest;
  std::vector<ReleaseContact> contacts;
};

/// Releases a body, with all its descendants, from a pose under a push: it moves onto the bone
/// beneath, rotates and slides until it is at rest. Yielding bodies are pushed along, and push
/// others in turn; all other bodies are fixed. The pushing hand has inertia and yields slowly, as
/// does the soft tissue around yielding bodies, so that bodies come to rest without impact.
/// Bit-identical for any thread count. A body that ends more than 0.1 mm deep in bone, by the exact
/// surfaces, is not at rest. An exception from `progress` cancels. throws: InputError when a body
/// does not roam (BodyTree::roams) or has no bone, one is a descendant of another, starts more than
/// 1 mm deep in bone, nothing lies within reach, or the push is zero or not finite.
Release release_body(const Case& patient, BodyId body, const BodyPoses& from,
                     const ReleaseSettings& settings, int threads = 1,
                     const Progress& progress = {});

}  // namespace condyle
