#pragma once

#include "engine/mesh/tri_mesh.h"

namespace condyle::test {

constexpr int plate_cells = 20;

/// A vertex of the lower (0) or upper (1) side of a plate.
inline int plate_vertex(int side, int i, int j) {
  return (side * (plate_cells + 1) + j) * (plate_cells + 1) + i;
}

/// A closed box of 20 x 20 mm with quads of 1 mm.
inline TriMesh plate(double thickness_mm) {
  constexpr int n = plate_cells;
  TriMesh mesh;
  for (int side = 0; side < 2; ++side)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) mesh.vertices.emplace_back(i, j, side * thickness_mm);
  const auto quad = [&](int a, int b, int c, int d) {
    mesh.triangles.emplace_back(a, b, c);
    mesh.triangles.emplace_back(a, c, d);
  };
  const auto at = plate_vertex;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      quad(at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1), at(1, i, j + 1));
      quad(at(0, i, j + 1), at(0, i + 1, j + 1), at(0, i + 1, j), at(0, i, j));
    }
  for (int i = 0; i < n; ++i) {
    quad(at(0, i, 0), at(0, i + 1, 0), at(1, i + 1, 0), at(1, i, 0));
    quad(at(0, i + 1, n), at(0, i, n), at(1, i, n), at(1, i + 1, n));
    quad(at(0, 0, i + 1), at(0, 0, i), at(1, 0, i), at(1, 0, i + 1));
    quad(at(0, n, i), at(0, n, i + 1), at(1, n, i + 1), at(1, n, i));
  }
  return mesh;
}

}  // namespace condyle::test
