#include "render/face/submental_pad.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "engine/math/smooth_step.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

constexpr float adult_width_mm = 50;  // of the mouth for which lengths are given
// The profile, from the lower lip downward.
constexpr float chin_from_mm = 12, chin_to_mm = 60, neck_mm = 95, gap_mm = 4;
constexpr float least_depth_mm = 8;  // of the cervical point behind chin and neck
constexpr float gauge_mm = 30;
// The pad about the cervical point.
constexpr float half_width_mm = 52, half_length_mm = 47;
constexpr double bulge_from = 0.75,
                 bulge_to = 0.4;  // distance of chin and throat over that at rest

/// Foremost skin of the midline that faces forward or down, by level of `step` from the top down.
std::map<int, Vector3f> midline(std::span<const Vector3f> rest,
                                std::span<const Eigen::Vector3i> triangles, float mid_x, float top,
                                float step) {
  std::map<int, Vector3f> levels;
  const Vector3f forward_or_down(0, -0.8f, -0.6f);
  for (const Eigen::Vector3i& t : triangles) {
    const std::array corners{rest[static_cast<std::size_t>(t[0])],
                             rest[static_cast<std::size_t>(t[1])],
                             rest[static_cast<std::size_t>(t[2])]};
    if ((corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(forward_or_down) <= 0)
      continue;
    std::vector<Vector3f> cut;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3f &a = corners[k], &b = corners[(k + 1) % 3];
      if ((a.x() < mid_x) == (b.x() < mid_x)) continue;
      cut.push_back(a + (mid_x - a.x()) / (b.x() - a.x()) * (b - a));
    }
    if (cut.size() != 2) continue;
    if (cut[0].z() < cut[1].z()) std::swap(cut[0], cut[1]);
    const auto first = static_cast<int>(std::ceil((top - cut[0].z()) / step));
    const auto last = static_cast<int>(std::floor((top - cut[1].z()) / step));
    for (int level = std::max(first, 0); level <= last; ++level) {
      const float z = top - static_cast<float>(level) * step;
      const float height = cut[0].z() - cut[1].z();
      const Vector3f at =
          height > 0 ? Vector3f(cut[0] + (cut[0].z() - z) / height * (cut[1] - cut[0])) : cut[0];
      const auto [found, is_new] = levels.try_emplace(level, at);
      if (!is_new && at.y() < found->second.y()) found->second = at;
    }
  }
  return levels;
}

int nearest_vertex(std::span<const Vector3f> rest, const Vector3f& point) {
  const auto off = [&](const Vector3f& v) { return (v - point).squaredNorm(); };
  return static_cast<int>(
      std::min_element(rest.begin(), rest.end(),
                       [&](const auto& a, const auto& b) { return off(a) < off(b); }) -
      rest.begin());
}

/// The skin about the cervical point, and two rings of vertices that hold it. Returns the vertices
/// in the order of the piece.
std::vector<int> cut_pad(std::span<const Vector3f> rest, std::span<const Eigen::Vector3i> triangles,
                         const NeckProfile& profile, SurfacePiece& piece) {
  enum Ring { outside = -1, moving, first, second };
  std::vector<int> ring(rest.size(), outside);
  const auto within = [&](const Vector3f& p) {
    const Vector3f off = (p - profile.cervical_point) / profile.unit;
    return std::hypot(off.x() / half_width_mm, std::hypot(off.y(), off.z()) / half_length_mm) < 1;
  };
  std::vector<Eigen::Vector3i> near;
  for (const Eigen::Vector3i& t : triangles)
    if (std::all_of(t.begin(), t.end(),
                    [&](int v) { return within(rest[static_cast<std::size_t>(v)]); }))
      near.push_back(t);
  ring[static_cast<std::size_t>(nearest_vertex(rest, profile.cervical_point))] = moving;
  for (bool grows = true; std::exchange(grows, false);)
    for (const Eigen::Vector3i& t : near) {
      const auto reached = [&](int v) { return ring[static_cast<std::size_t>(v)] == moving; };
      const auto count = std::count_if(t.begin(), t.end(), reached);
      if (count == 0 || count == 3) continue;
      for (const int v : t) ring[static_cast<std::size_t>(v)] = moving;
      grows = true;
    }
  for (const int grown : {first, second}) {
    auto next = ring;
    for (const Eigen::Vector3i& t : triangles) {
      const auto inside = [&](int v) { return ring[static_cast<std::size_t>(v)] != outside; };
      if (std::none_of(t.begin(), t.end(), inside)) continue;
      for (const int v : t)
        if (!inside(v)) next[static_cast<std::size_t>(v)] = grown;
    }
    ring = std::move(next);
  }
  std::vector<int> vertices, own(rest.size(), -1);
  for (const int kind : {moving, first, second}) {
    for (std::size_t v = 0; v < rest.size(); ++v)
      if (ring[v] == kind) {
        own[v] = static_cast<int>(vertices.size());
        vertices.push_back(static_cast<int>(v));
        piece.rest.push_back(rest[v]);
      }
    if (kind == moving) piece.moving = vertices.size();
    if (kind == first) piece.bending = vertices.size();
  }
  for (const Eigen::Vector3i& t : triangles) {
    const Eigen::Vector3i mine(own[static_cast<std::size_t>(t[0])],
                               own[static_cast<std::size_t>(t[1])],
                               own[static_cast<std::size_t>(t[2])]);
    if (mine.minCoeff() >= 0) piece.triangles.push_back(mine);
  }
  return vertices;
}

}  // namespace

std::optional<NeckProfile> find_neck_profile(std::span<const Vector3f> rest,
                                             std::span<const Eigen::Vector3i> triangles,
                                             std::span<const int> rim) {
  if (rim.empty()) return std::nullopt;
  Eigen::AlignedBox3f mouth;
  for (const int v : rim) mouth.extend(rest[static_cast<std::size_t>(v)]);
  const float unit = mouth.sizes().x() / adult_width_mm;
  if (unit <= 0) return std::nullopt;
  const auto levels = midline(rest, triangles, mouth.center().x(), mouth.min().z(), unit);
  std::vector<Vector3f> points;
  std::size_t chin = 0;
  int before = static_cast<int>(chin_from_mm);
  for (const auto& [level, point] : levels) {
    const auto down = static_cast<float>(level);
    if (down < chin_from_mm) continue;
    if (level - before > gap_mm) break;  // below it only the nape is left
    before = level;
    points.push_back(point);
    if (down <= chin_to_mm && point.y() < points[chin].y()) chin = points.size() - 1;
    if (down > chin_to_mm && (point - points[chin]).norm() > neck_mm * unit) break;
  }
  if (points.size() < chin + 3) return std::nullopt;
  const Vector3f& neck = points.back();
  const Vector3f along = (neck - points[chin]).normalized();
  const Vector3f behind(0, -along.z(), along.y());  // across the chord
  std::size_t deepest = chin;
  const auto depth = [&](std::size_t i) { return (points[i] - points[chin]).dot(behind); };
  for (std::size_t i = chin; i < points.size(); ++i)
    if (depth(i) > depth(deepest)) deepest = i;
  if (depth(deepest) < least_depth_mm * unit) return std::nullopt;
  const auto beside = [&](int step) {
    auto i = static_cast<std::ptrdiff_t>(deepest);
    const auto end = step < 0 ? static_cast<std::ptrdiff_t>(chin)
                              : static_cast<std::ptrdiff_t>(points.size()) - 1;
    while (i != end &&
           (points[static_cast<std::size_t>(i)] - points[deepest]).norm() < gauge_mm * unit)
      i += step;
    return points[static_cast<std::size_t>(i)];
  };
  return NeckProfile{points[chin], points[deepest], beside(-1), beside(1), unit};
}

SubmentalPad::SubmentalPad(std::span<const Vector3f> rest,
                           std::span<const Eigen::Vector3i> triangles, std::span<const int> rim) {
  const auto profile = find_neck_profile(rest, triangles, rim);
  if (!profile) return;
  const int chin = nearest_vertex(rest, profile->chin);
  const int throat = nearest_vertex(rest, profile->throat);
  const float apart =
      (rest[static_cast<std::size_t>(chin)] - rest[static_cast<std::size_t>(throat)]).norm();
  if (apart <= 0) return;
  SurfacePiece piece;
  auto vertices = cut_pad(rest, triangles, *profile, piece);
  if (vertices.size() == piece.moving) return;  // nothing holds it
  piece.stiff_mm *= profile->unit;
  pad_.emplace(Pad{chin, throat, apart, std::move(vertices),
                   MadeOnce<SpanningSurface, SurfacePiece>(std::move(piece))});
}

void SubmentalPad::apply(std::vector<Vector3f>& places) const {
  if (!pad_) return;
  const double ratio = (places[static_cast<std::size_t>(pad_->chin)] -
                        places[static_cast<std::size_t>(pad_->throat)])
                           .norm() /
                       pad_->rest_mm;
  const auto share =
      static_cast<float>(smooth_step((bulge_from - ratio) / (bulge_from - bulge_to)));
  if (share <= 0) return;
  const SpanningSurface& surface = pad_->surface.get();
  std::vector<Vector3f> now;
  now.reserve(pad_->vertices.size());
  for (const int v : pad_->vertices) now.push_back(places[static_cast<std::size_t>(v)]);
  const auto spanned = surface.across(now);
  for (std::size_t i = 0; i < spanned.size(); ++i) {
    const Vector3f drawn = spanned[i] + static_cast<float>(ratio) * surface.rest_offset()[i];
    places[static_cast<std::size_t>(pad_->vertices[i])] += share * (drawn - now[i]);
  }
}

}  // namespace condyle
