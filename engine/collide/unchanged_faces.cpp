#include "engine/collide/unchanged_faces.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "engine/core/hash.h"
#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Corners = std::array<double, 9>;

/// The corners of a triangle, in its order: from another first corner distances are rounded
/// differently.
Corners corners_of(const TriMesh& mesh, const Eigen::Vector3i& triangle) {
  Corners corners;
  for (std::size_t k = 0; k < 9; ++k)
    corners[k] = mesh.vertices[static_cast<std::size_t>(triangle[static_cast<int>(k / 3)])]
                              [static_cast<int>(k % 3)];
  return corners;
}

/// The triangles of some shells, to be found by their corners.
class Triangles {
 public:
  explicit Triangles(std::span<const Shell> shells) {
    for (const Shell& shell : shells)
      for (const auto& t : shell.mesh.triangles) corners_.push_back(corners_of(shell.mesh, t));
    for (std::size_t i = 0; i < corners_.size(); ++i) by_hash_.emplace_back(hash(corners_[i]), i);
    std::sort(by_hash_.begin(), by_hash_.end());
  }

  std::optional<std::size_t> find(const Corners& corners) const {
    const std::uint64_t h = hash(corners);
    auto at = std::lower_bound(by_hash_.begin(), by_hash_.end(), std::pair(h, std::size_t(0)));
    for (; at != by_hash_.end() && at->first == h; ++at)
      if (corners_[at->second] == corners) return at->second;
    return std::nullopt;
  }

  const std::vector<Corners>& corners() const { return corners_; }

 private:
  static std::uint64_t hash(const Corners& corners) {
    return hash_values(std::span<const double>(corners));
  }

  std::vector<Corners> corners_;
  std::vector<std::pair<std::uint64_t, std::size_t>> by_hash_;
};

}  // namespace

UnchangedFaces::UnchangedFaces(std::span<const Shell> piece, std::span<const FieldFace> faces,
                               std::span<const Shell> uncut, double reach_mm)
    : unchanged_(faces.size()) {
  const Triangles triangles(uncut);
  std::vector<bool> is_in_piece(triangles.corners().size());
  Box near;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const TriMesh& mesh = piece[static_cast<std::size_t>(faces[i].shell)].mesh;
    const Corners corners =
        corners_of(mesh, mesh.triangles[static_cast<std::size_t>(faces[i].triangle)]);
    for (std::size_t k = 0; k < 9; k += 3) near.add({corners[k], corners[k + 1], corners[k + 2]});
    if (const auto same = triangles.find(corners)) {
      unchanged_[i] = true;
      is_in_piece[*same] = true;
    }
  }
  near.low.array() -= reach_mm;
  near.high.array() += reach_mm;
  TriMesh missing;
  for (std::size_t i = 0; i < is_in_piece.size(); ++i) {
    if (is_in_piece[i]) continue;
    const Corners& c = triangles.corners()[i];
    Box box;
    const auto first = static_cast<int>(missing.vertices.size());
    for (std::size_t k = 0; k < 9; k += 3) box.add({c[k], c[k + 1], c[k + 2]});
    if ((box.low.array() > near.high.array()).any() || (box.high.array() < near.low.array()).any())
      continue;
    for (std::size_t k = 0; k < 9; k += 3) missing.vertices.emplace_back(c[k], c[k + 1], c[k + 2]);
    missing.triangles.emplace_back(first, first + 1, first + 2);
  }
  if (!missing.empty()) missing_.emplace(missing);
}

}  // namespace condyle
