#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sim/tissue/tissue.h"

namespace condyle {

// Elements of the tissue model as lines for drawing; positions as in the state, mm.

using MeshLine = std::array<Eigen::Vector3f, 2>;

/// A spring between two nodes.
struct SpringLine {
  MeshLine ends;
  float stretch = 1;  // length over rest length
  int layer = 0;      // 0 outermost
};
std::vector<SpringLine> spring_lines(const TissueModel& model, const TissueState& state);

/// Edges of the prisms, each once.
std::vector<MeshLine> prism_lines(const TissueModel& model, const TissueState& state);

/// Springs to bone: from each attached node to its target on the bone.
struct BoneSpringLine {
  MeshLine ends;         // node, target
  double moving_weight;  // 0: the target moves with the cranium, 1: with moving bodies
};
std::vector<BoneSpringLine> bone_spring_lines(const TissueModel& model, const TissueState& state);

}  // namespace condyle
