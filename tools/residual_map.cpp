#include "tools/residual_map.h"

#include <algorithm>
#include <cmath>

#include "engine/mesh_io/mesh_files.h"

namespace condyle {

void ResidualMap::add(const TriMesh& scan, const Pose& X_CS, std::span<const float> residual_mm) {
  const int offset = static_cast<int>(mesh_.vertices.size());
  for (const auto& v : scan.vertices) mesh_.vertices.push_back(X_CS * v);
  for (const auto& t : scan.triangles)
    mesh_.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
  residual_mm_.insert(residual_mm_.end(), residual_mm.begin(), residual_mm.end());
  for (const float residual : residual_mm) {
    if (std::isnan(residual)) {
      mesh_.colors.emplace_back(.5f, .5f, .5f);
      continue;
    }
    const float s = std::clamp(residual / static_cast<float>(full_mm_), -1.f, 1.f);
    mesh_.colors.emplace_back(s > 0 ? 1.f : 1 + s, 1 - std::abs(s), s < 0 ? 1.f : 1 - s);
  }
}

void ResidualMap::write(const std::filesystem::path& file) const {
  write_ply(mesh_, "distance_mm", residual_mm_, file);
}

}  // namespace condyle
