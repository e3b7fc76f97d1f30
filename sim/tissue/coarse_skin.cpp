#include "sim/tissue/coarse_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/tissue/remesh.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Factor by which edges may be longer than at the lips, by the distance to the mouth (mm).
double coarseness(double to_mouth) { return 1 + 1.6 * std::clamp((to_mouth - 6) / 70, 0.0, 1.0); }

/// The same by the distance to an eye.
double coarseness_at_eye(double to_eye) {
  return 1.5 + 1.1 * std::clamp((to_eye - 8) / 35, 0.0, 1.0);
}

double to_eyes(const SkinRegion& region, const Vector3d& p) {
  return std::min(region.eyes->left.distance(p), region.eyes->right.distance(p));
}

/// The border loop of the mouth in two runs between its corners, right and left.
MouthOutline mouth_along(const std::vector<int>& loop, const std::vector<int>& corners,
                         bool one_is_upper) {
  MouthOutline mouth;
  mouth.right_corner = corners[0];
  mouth.left_corner = corners[1];
  const int n = static_cast<int>(loop.size());
  const int right =
      static_cast<int>(std::find(loop.begin(), loop.end(), corners[0]) - loop.begin());
  std::vector<int> one, other;
  int i = (right + 1) % n;
  for (; loop[i] != corners[1] && i != right; i = (i + 1) % n) one.push_back(loop[i]);
  for (i = (i + 1) % n; i != right && i != (right + n) % n; i = (i + 1) % n)
    other.push_back(loop[i]);
  std::reverse(other.begin(), other.end());
  mouth.upper = one_is_upper ? one : other;
  mouth.lower = one_is_upper ? other : one;
  return mouth;
}

}  // namespace

CoarseSkin make_coarse_skin(const SkinRegion& region, int lower_nodes) {
  constexpr double lid_mm = 12;  // from the line between the canthi
  const TriMesh& fine = region.mesh;
  std::vector<Vector3d> lips;
  for (const auto* run : {&region.mouth.upper, &region.mouth.lower})
    for (std::size_t i = 0; i < run->size(); i += 1 + run->size() / 24)
      lips.push_back(fine.vertices[(*run)[i]]);
  const auto to_mouth = [&](const Vector3d& p) {
    double best = lips.empty() ? 60 * 60 : 1e18;
    for (const auto& lip : lips) best = std::min(best, (p - lip).squaredNorm());
    return std::sqrt(best);
  };

  const auto factor = [&](const Vector3d& p) {
    const double by_mouth = coarseness(to_mouth(p));
    return region.eyes ? std::min(by_mouth, coarseness_at_eye(to_eyes(region, p))) : by_mouth;
  };

  // A uniform triangle mesh with edges of length l has 2 / sqrt(3) / l^2 vertices per area. The
  // upper face has nodes beyond those of the lower.
  RegionShape lower = region.shape;
  lower.upper_face = false;
  double expected = 0, of_lower = 0;
  for (const auto& t : fine.triangles) {
    const Vector3d &a = fine.vertices[t[0]], &b = fine.vertices[t[1]], &c = fine.vertices[t[2]];
    const Vector3d centre = (a + b + c) / 3;
    const double area = 0.5 * (b - a).cross(c - a).norm() * 2 / std::sqrt(3.0);
    const double l = factor(centre);
    expected += area / (l * l);
    if (!region.eyes) continue;
    const double l_lower = coarseness(to_mouth(centre));
    if (lower.inside(centre) > 0) of_lower += area / (l_lower * l_lower);
  }
  const double nodes = region.eyes ? std::round(lower_nodes * expected / of_lower) : lower_nodes;
  double scale = std::sqrt(expected / nodes);
  RemeshSettings settings;
  if (region.mouth.found()) settings.pinned = {region.mouth.right_corner, region.mouth.left_corner};
  Remeshed coarse;
  for (int attempt = 0; attempt < 3; ++attempt) {
    settings.edge_length = [&](const Vector3d& p) { return scale * factor(p); };
    coarse = remesh(fine, settings);
    const double got = static_cast<double>(coarse.mesh.vertices.size());
    if (std::abs(got / nodes - 1) < 0.04) break;
    scale *= std::sqrt(got / nodes);
  }

  CoarseSkin skin;
  skin.eyes = region.eyes;
  skin.mesh = std::move(coarse.mesh);
  skin.rim.assign(skin.mesh.vertices.size(), 0);
  skin.border.assign(skin.mesh.vertices.size(), 0);

  // Border vertices have slid along the fine borders: each takes the kind of the nearest fine
  // border vertex.
  enum class Kind { rim, border };
  std::vector<std::pair<Vector3d, Kind>> marks;
  for (int v : region.rim) marks.emplace_back(fine.vertices[v], Kind::rim);
  for (int v : region.border) marks.emplace_back(fine.vertices[v], Kind::border);
  const auto loops = border_loops(skin.mesh);
  int mouth_loop = -1;
  if (region.mouth.found())
    for (std::size_t l = 0; l < loops.size(); ++l)
      if (std::find(loops[l].begin(), loops[l].end(), coarse.pinned[0]) != loops[l].end())
        mouth_loop = static_cast<int>(l);
  for (std::size_t l = 0; l < loops.size(); ++l) {
    if (static_cast<int>(l) == mouth_loop) continue;
    for (int v : loops[l]) {
      double best = 1e18;
      Kind kind = Kind::rim;
      for (const auto& [p, k] : marks)
        if ((p - skin.mesh.vertices[v]).squaredNorm() < best) {
          best = (p - skin.mesh.vertices[v]).squaredNorm();
          kind = k;
        }
      // The margins of the lids are no border that follows a jaw.
      if (kind == Kind::border && skin.eyes && to_eyes(region, skin.mesh.vertices[v]) < lid_mm)
        continue;
      (kind == Kind::rim ? skin.rim : skin.border)[v] = 1;
    }
  }
  if (mouth_loop >= 0) {
    skin.mouth = mouth_along(loops[mouth_loop], coarse.pinned, faces_outward(skin.mesh));
  }
  return skin;
}

}  // namespace condyle
