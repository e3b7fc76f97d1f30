#pragma once

#include <Eigen/Core>
#include <vector>

namespace condyle {

/// Places that a surface was sampled at.
struct SamplePlaces {
  std::vector<Eigen::Vector3d> points, normals;
  std::vector<float> spread;  // cosine of the widest angle to a face's normal there
};

/// Drops samples that others stand for: one lies within `reach_mm`, of nearly the same normal, and
/// the surface rises above it by no more than `rise_mm` on the way. Slender triangles and fine
/// meshes give three samples where one does. The sharpest stay; same bits each time.
SamplePlaces thinned(const SamplePlaces& all, double reach_mm, double rise_mm);

}  // namespace condyle
