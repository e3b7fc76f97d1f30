#pragma once

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// What a surface is made of; all counts are zero-tolerance (by vertex index).
struct MeshFacts {
  int pieces = 0;              // connected through shared vertices
  int open_edges = 0;          // one triangle only
  int non_manifold_edges = 0;  // more than two triangles, or two that run the same way
  int pinched_vertices = 0;    // more than one fan of triangles meets there
  int bad_triangles = 0;       // repeated corner or area below 1e-8 mm2
  double volume = 0;           // mm3, positive when triangles face outward
  bool closed() const { return open_edges == 0 && non_manifold_edges == 0; }
};

MeshFacts mesh_facts(const TriMesh& mesh);

/// The piece with the most triangles; the others are dropped.
TriMesh largest_piece(const TriMesh& mesh);

}  // namespace condyle
