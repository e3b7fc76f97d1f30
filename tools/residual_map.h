#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Registered scans coloured by their distances from what they were registered to.
class ResidualMap {
 public:
  /// full_mm: distance of the strongest colours.
  explicit ResidualMap(double full_mm) : full_mm_(full_mm) {}

  /// residual_mm: by vertex; positive outside, NaN without a partner.
  void add(const TriMesh& scan, const Pose& X_CS, std::span<const float> residual_mm);
  /// As PLY: blue inside, red outside, grey without a partner, and the property distance_mm.
  void write(const std::filesystem::path& file) const;

 private:
  double full_mm_;
  TriMesh mesh_;
  std::vector<float> residual_mm_;
};

}  // namespace condyle
