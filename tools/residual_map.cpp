#include "tools/residual_map.h"

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/core/text_table.h"
#include "engine/mesh_io/mesh_files.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

fs::path whole(const fs::path& path) {
  std::error_code ignored;
  return fs::weakly_canonical(fs::absolute(path), ignored);
}

bool lies_in(const fs::path& file, const fs::path& folder) {
  const auto [end, ignored] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return end == folder.end();
}

}  // namespace

void check_residual_file(const fs::path& file, std::initializer_list<fs::path> folders,
                         std::initializer_list<fs::path> inputs) {
  if (file.empty()) return;
  const fs::path map = whole(file);
  if (lower_case(map.extension().string()) != ".ply")
    throw InputError("--residuals " + file.string() + ": the map is a PLY file (.ply)");
  if (!fs::is_directory(map.parent_path()))
    throw InputError("--residuals " + file.string() + ": there is no such folder");
  for (const fs::path& folder : folders)
    if (!folder.empty() && lies_in(map, whole(folder)))
      throw InputError("--residuals " + file.string() + ": lies in the folder of a case, " +
                       folder.string());
  for (const fs::path& input : inputs)
    if (!input.empty() && map == whole(input))
      throw InputError("--residuals " + file.string() + ": would replace a file that is read");
}

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
