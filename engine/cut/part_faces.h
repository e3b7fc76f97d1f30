#pragma once

#include <array>
#include <vector>

#include "engine/cut/cell_complex.h"
#include "engine/cut/join_cells.h"

namespace condyle {

/// A triangle of a part's surface, facing outward.
struct PartFace {
  std::array<int, 3> vertices;  // of the complex
  int source, wall;
};

/// The surface of each part. Triangles of the mesh whose fragments all belong to one part are made
/// whole again. Of the new vertices on edges of the mesh only corners of cut faces stay.
std::vector<std::vector<PartFace>> part_faces(const CellComplex& complex, const JoinedCells& joined,
                                              const TriMesh& mesh);

/// Gives each sheet of faces its own vertices and edges where several touch along an edge or in a
/// point, so that each edge has two faces and each vertex one fan. New vertices are appended to
/// `vertices`, with the vertex or edge they are copies of in `copies`.
struct VertexCopy {
  int low, high;  // middle of an edge, or both the same
};
void part_touching_sheets(std::vector<PartFace>& faces, std::vector<Eigen::Vector3d>& vertices,
                          std::vector<VertexCopy>& copies);

}  // namespace condyle
