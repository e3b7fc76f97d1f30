#pragma once

#include <vector>

#include "tests/render/scene_fixture.h"

namespace condyle {

/// A round face of radius 60 mm with a slit of 50 mm for a mouth, and a ball for each jaw's teeth.
inline std::vector<Part> head_with_slit(TriMesh face) {
  std::erase_if(face.triangles, [&](const Eigen::Vector3i& t) {
    const Eigen::Vector3d p = (face.vertices[t[0]] + face.vertices[t[1]] + face.vertices[t[2]]) / 3;
    return p.y() < 0 && std::hypot(p.x() / 25, p.z() / 3) < 1;
  });
  return {make_part("face", Role::face, face),
          make_part("upper_teeth", Role::upper_teeth, ball({0, -38, 6}, 16, 16)),
          make_part("lower_teeth", Role::lower_teeth, ball({0, -38, -6}, 16, 16))};
}

}  // namespace condyle
