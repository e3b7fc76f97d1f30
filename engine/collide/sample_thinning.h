#pragma once

#include <Eigen/Core>
#include <vector>

namespace condyle {

/// Points at which a surface is sampled.
struct SamplePoints {
  std::vector<Eigen::Vector3d> points, normals;
  std::vector<float> spread;  // cosine of the widest angle to a face's normal there
};

/// Removes redundant samples: those with another sample within `reach_mm` that has nearly the same
/// normal and above which the surface between them rises by at most `rise_mm`. Slender triangles
/// and fine meshes give three samples where one suffices. The sharpest are kept; deterministic.
SamplePoints thinned(const SamplePoints& all, double reach_mm, double rise_mm);

}  // namespace condyle
