#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "engine/mesh/measure.h"
#include "sim/case/case.h"

namespace condyle {

/// One dental arch at rest: a part of separate or joined teeth, or the bone that carries its
/// crowns.
struct Arch {
  const Part* part = nullptr;
  Box crowns;                             // bounding box of the crowns, with a margin
  Eigen::Vector3d edge;                   // midpoint of the incisal edge
  std::array<Eigen::Vector3d, 2> molars;  // cusps of the first molars: left, right
  Eigen::Vector3d middle() const { return (edge + molars[0] + molars[1]) / 3; }
};

/// Both arches of a case, and the directions in which a bite is described.
struct Arches {
  Arch upper, lower;
  // Unit vectors, cranium: normal of the upper arch's occlusal plane (incisal edge and first
  // molars), upward; forward in that plane; to the patient's left.
  Eigen::Vector3d up, front, left;
  double midline_mm = 0;                                   // x
  std::optional<std::array<Eigen::Vector3d, 2>> condyles;  // centres at rest: left, right
  std::vector<std::string> notes;                          // how they were found, as sentences
};

/// The teeth of the bodies that carry the arches (see JawBodies); where a body has none, that bone
/// of it on whose surface the incisal landmark lies. The case must outlive the result. throws:
/// InputError naming what is missing.
Arches find_arches(const Case& patient);

/// The pose of the lower arch with normal incisors (overjet and overbite 2.5 mm) under the upper
/// one, on a common midline and with parallel occlusal planes.
Pose normal_relation(const Arches& arches);

}  // namespace condyle
