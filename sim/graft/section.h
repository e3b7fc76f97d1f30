#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "engine/cut/region.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

using SectionLine = std::array<Eigen::Vector3d, 2>;

/// The lines in which a plane meets a surface, in the order of its triangles.
inline std::vector<SectionLine> plane_section(const TriMesh& mesh, const Plane& plane) {
  std::vector<SectionLine> lines;
  for (const auto& t : mesh.triangles) {
    SectionLine line;
    int ends = 0;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d &a = mesh.vertices[t[k]], &b = mesh.vertices[t[(k + 1) % 3]];
      const double da = plane.distance(a), db = plane.distance(b);
      if ((da > 0) != (db > 0) && ends < 2) line[ends++] = a + (b - a) * (da / (da - db));
    }
    if (ends == 2) lines.push_back(line);
  }
  return lines;
}

}  // namespace condyle
