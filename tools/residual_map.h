#pragma once

#include <filesystem>
#include <initializer_list>
#include <span>
#include <vector>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Checks the file of a map before the work. throws: InputError when it is no PLY file, lies in no
/// folder that exists or in one of the cases `folders`, or is one of `inputs`. Empty paths pass.
void check_residual_file(const std::filesystem::path& file,
                         std::initializer_list<std::filesystem::path> folders,
                         std::initializer_list<std::filesystem::path> inputs);

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
