#pragma once

#include <array>
#include <vector>

#include "engine/tissue/spring_prism.h"

/// A reference independent of springs and prisms: corotational linear finite elements on four-node
/// tetrahedra.
namespace condyle::fe {

struct Elastic {
  double young_MPa = 0.02;
  double poisson = 0.25;
};

struct Body {
  Nodes rest;                            // mm
  std::vector<std::array<int, 4>> tets;  // of positive volume
  Elastic elastic;
};

/// The prisms of a layered mesh, each as three tetrahedra whose faces agree with the neighbours'.
Body body_of(const SpringPrismMesh& mesh, const Nodes& rest, const Elastic& elastic);

struct Given {
  std::vector<int> node;
  Nodes at;     // mm, where each given node is
  Nodes force;  // N, one per node of the body, or none
};

struct Solution {
  Nodes nodes;
  int rounds = 0;
  double last_change = 0;  // mm, of any node in the last round
};

/// Equilibrium. Each round solves the linear elements in coordinate frames that turn with them;
/// rounds == 1 is small-displacement elasticity.
/// source: Mueller, Dorsey, McMillan, Jagnow, Cutler, Stable real-time deformations, 2002.
Solution solve(const Body& body, const Given& given, int rounds, double tolerance_mm = 1e-4);

}  // namespace condyle::fe
