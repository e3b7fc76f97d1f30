#pragma once

#include "engine/mesh/tri_mesh.h"

namespace condyle {

struct UnfoldSettings {
  double cosine = -0.5;  // neighbours whose normals enclose more than this angle are folded
  double most_mm = 0.5;  // that a vertex moves
  int rounds = 20;
};

/// Moves the corners of triangles that are folded onto their neighbours to the means of their
/// neighbours, until there is no fold, or no more progress: folds turn inside and outside round
/// for queries of signed distance. The triangles stay. Returns the number of folded edges left.
int unfold(TriMesh& mesh, const UnfoldSettings& settings = {});

}  // namespace condyle
