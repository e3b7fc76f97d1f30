#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace condyle {

/// A vertex in a narrow fold and the opposite one: touching lips shade each other only while they
/// touch.
struct Crease {
  int vertex, across;
  float rest_mm;  // distance between the two
};

/// Folds up to 10 mm wide among vertices that see less than `dark` of the sky.
std::vector<Crease> find_creases(std::span<const Eigen::Vector3f> positions,
                                 std::span<const Eigen::Vector3f> normals,
                                 std::span<const float> sky, float dark = 0.75f);

/// The sky fraction of a vertex of a fold once the sides have moved apart.
float opened_sky(const Crease& crease, float sky, std::span<const Eigen::Vector3f> positions);

}  // namespace condyle
