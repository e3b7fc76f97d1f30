#include "engine/tissue/mesh_point.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "engine/tissue/layered_mesh.h"

namespace condyle {

void spread(const std::vector<Eigen::Vector3i>& triangles, const Nodes& rest, double spacing_mm,
            std::vector<MeshPoint>& points) {
  assert(spacing_mm > 0);
  const auto parts_of = [&](int a, int b) {
    return static_cast<int>(std::ceil((rest[a] - rest[b]).norm() / spacing_mm));
  };
  for (const auto& [a, b] : edges_of(triangles)) {
    const int parts = parts_of(a, b);
    const double part = 1.0 / parts;
    for (int i = 1; i < parts; ++i) points.push_back({{a, b}, {1 - i * part, i * part}, 2});
  }
  for (const auto& t : triangles) {
    const int parts = std::max({parts_of(t[0], t[1]), parts_of(t[1], t[2]), parts_of(t[2], t[0])});
    const double part = 1.0 / parts;
    for (int i = 1; i < parts; ++i)
      for (int j = 1; i + j < parts; ++j)
        points.push_back({{t[0], t[1], t[2]}, {1 - (i + j) * part, i * part, j * part}, 3});
  }
}

}  // namespace condyle
