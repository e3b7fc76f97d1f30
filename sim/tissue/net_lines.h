#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sim/tissue/tissue.h"

namespace condyle {

// What the tissue's model is made of, as lines for drawing; places as in the state, mm.

using NetLine = std::array<Eigen::Vector3f, 2>;

/// A spring between two nodes.
struct NetSpringLine {
  NetLine ends;
  float stretch = 1;  // length over rest length
  int layer = 0;      // 0 outermost
};
std::vector<NetSpringLine> spring_lines(const TissueModel& model, const TissueState& state);

/// Edges of the prisms, each once.
std::vector<NetLine> prism_lines(const TissueModel& model, const TissueState& state);

/// Springs to bone: from each attached node to the place where its bone wants it.
struct BoneSpringLine {
  NetLine ends;           // node, place
  double mandible_share;  // 1: the mandible's, 0: the cranium's
};
std::vector<BoneSpringLine> bone_spring_lines(const TissueModel& model, const TissueState& state);

}  // namespace condyle
