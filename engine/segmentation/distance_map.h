#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace condyle {

/// In a distance map before it is made: no feature here.
constexpr float no_feature = 1e20f;

/// Replaces features (0) and other voxels (no_feature) by the squared distance to the nearest
/// feature, mm^2, exactly. Without a feature all stay. Bit-identical for any number of threads.
/// source: Felzenszwalb and Huttenlocher 2012.
void make_squared_distances(std::vector<float>& map, const std::array<int, 3>& size,
                            const Eigen::Vector3d& spacing_mm, int threads);

}  // namespace condyle
