#pragma once

#include <algorithm>
#include <optional>

#include "engine/collide/solid.h"
#include "engine/collide/surface_samples.h"

namespace condyle::test {

/// Deepest point of either of two surfaces in the other: exact distances at samples a sixth of a
/// millimetre apart, on sharp edges a twentieth.
class OverlapOracle {
 public:
  /// `region`: only there is its surface tested against the other.
  explicit OverlapOracle(const TriMesh& mesh, const std::optional<Box>& region = {})
      : solid_(mesh),
        samples_(sample_surface(mesh, {.spacing_mm = 0.17,
                                       .edge_rise_mm = 0.002,
                                       .edge_spacing_mm = 0.05,
                                       .region = region,
                                       .thin_fraction = 0})) {}

  friend double deepest(const OverlapOracle& a, const OverlapOracle& b, const Pose& X_AB) {
    double depth = 0;
    b.search(0, a.solid_, X_AB, depth);
    a.search(0, b.solid_, X_AB.inverse(), depth);
    return depth;
  }

 private:
  void search(int index, const Solid& other, const Pose& X, double& depth) const {
    const auto& ball = samples_.balls[index];
    if (other.signed_distance(X * ball.center.cast<double>()) - ball.radius >= -depth) return;
    if (ball.right != 0) {
      search(index + 1, other, X, depth);
      search(ball.right, other, X, depth);
      return;
    }
    for (int i = ball.first; i < ball.first + ball.count; ++i)
      depth = std::max(depth, -other.signed_distance(X * samples_.points[i]));
  }

  Solid solid_;
  SurfaceSamples samples_;
};

}  // namespace condyle::test
