#include "render/face/skin_folds.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace condyle {
namespace {

using Eigen::Vector3f;

constexpr float facing = 0.3f;  // cosine above which skin belongs to a line: the lining does not
constexpr float bulge_at = 3.2f, bulge_width = 2.6f;  // over the half width of the groove
constexpr float reach = bulge_at + 2 * bulge_width;
constexpr float dark_per_mm = 0.28f, darkest = 0.6f;
constexpr int even_passes = 6;        // of the directions of displacement
constexpr int smoothing_passes = 24;  // along a line: a fold runs on beyond what causes it

/// Vertex of the skin nearest to a position.
int nearest_skin(std::span<const int> candidates, std::span<const Vector3f> rest,
                 const Vector3f& at) {
  int best = candidates.front();
  float least = std::numeric_limits<float>::infinity();
  for (const int v : candidates)
    if (const float d = (rest[static_cast<std::size_t>(v)] - at).squaredNorm(); d < least)
      least = d, best = v;
  return best;
}

/// Displacement across a fold of depth 1; off: distance over the half width of the groove, positive
/// on the side that bulges, where the groove is steeper.
float profile(float off, float bulge) {
  const float side = off > 0 ? 1.1f * off : 0.8f * off;
  const float raised = (off - bulge_at) / bulge_width;
  return bulge * std::exp(-raised * raised) - std::exp(-side * side);
}

}  // namespace

SkinFolds::SkinFolds(std::span<const Vector3f> rest, std::span<const Vector3f> normals,
                     std::span<const Eigen::Vector3i> triangles, std::span<const int> rim) {
  std::vector<int> used(rest.size(), -1);
  for (FoldLine& line : find_fold_lines(rest, normals, rim)) {
    const auto number = static_cast<int>(lines_.size());
    const auto n = line.samples.size();
    const float far =
        std::max(reach * line.groove_mm, std::max(2 * line.gauge_mm, 1.2f * line.far_mm));
    Eigen::AlignedBox3f box;
    for (const auto& sample : line.samples) box.extend(sample.point);
    box.extend(Vector3f(box.min().array() - far));
    box.extend(Vector3f(box.max().array() + far));
    const auto belongs = [&](std::size_t v) {
      return std::any_of(line.samples.begin(), line.samples.end(),
                         [&](const FoldLine::Sample& sample) {
                           return (rest[v] - sample.point).squaredNorm() < far * far &&
                                  normals[v].dot(sample.normal) > facing;
                         });
    };
    std::vector<int> near;
    for (std::size_t v = 0; v < rest.size(); ++v)
      if (box.contains(rest[v]) && belongs(v)) near.push_back(static_cast<int>(v));
    if (near.empty()) continue;
    Line made{line, {}};
    for (const auto& sample : line.samples)
      for (const float out : {line.gauge_mm, std::max(line.gauge_mm, line.far_mm)}) {
        const int from = nearest_skin(near, rest, sample.point - line.gauge_mm * sample.across),
                  to = nearest_skin(near, rest, sample.point + out * sample.across);
        made.gauges.push_back(
            {from, to,
             (rest[static_cast<std::size_t>(from)] - rest[static_cast<std::size_t>(to)]).norm()});
      }
    lines_.push_back(std::move(made));
    for (const int v : near) {
      const Vector3f& p = rest[static_cast<std::size_t>(v)];
      float least = std::numeric_limits<float>::infinity();
      Member member{v, number, 0, 0, 0};
      float beyond = 0;  // the line's ends, over the half width of the groove
      for (std::size_t i = 0; i + 1 < n; ++i) {
        const auto &a = line.samples[i], &b = line.samples[i + 1];
        const Vector3f along = b.point - a.point;
        const float at = (p - a.point).dot(along) / along.squaredNorm(),
                    t = std::clamp(at, 0.f, 1.f);
        const Vector3f off = p - a.point - t * along;
        if (off.norm() >= least) continue;
        least = off.norm();
        const float x =
            (off.dot((1 - t) * a.across + t * b.across) < 0 ? -least : least) / line.groove_mm;
        member.along = static_cast<float>(i) + t;
        member.height = std::abs(x) < reach ? profile(x, line.bulge) : 0;
        member.dark = std::exp(-x * x);
        const bool before = i == 0 && at < 0, after = i + 2 == n && at > 1;
        beyond = before || after ? std::abs(at - t) * along.norm() / line.groove_mm : 0;
      }
      const float ends = std::exp(-beyond * beyond);
      member.height *= ends;
      member.dark *= ends;
      if (std::abs(member.height) < 1e-3f) continue;
      used[static_cast<std::size_t>(v)] = 0;
      members_.push_back(member);
    }
  }
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] == 0) {
      used[v] = static_cast<int>(vertices_.size());
      vertices_.push_back(static_cast<int>(v));
    }
  for (Member& member : members_) member.own = used[static_cast<std::size_t>(member.own)];
  for (const Eigen::Vector3i& t : triangles) {
    const Eigen::Vector3i own(used[static_cast<std::size_t>(t[0])],
                              used[static_cast<std::size_t>(t[1])],
                              used[static_cast<std::size_t>(t[2])]);
    if (own.maxCoeff() < 0) continue;
    triangles_.push_back(t);
    corners_own_.push_back(own);
  }
}

std::vector<float> SkinFolds::depths(const Line& line, std::span<const Vector3f> places) const {
  const auto n = line.line.samples.size();
  const FoldLine& fold = line.line;
  std::vector<float> surplus(n, 0), depth(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < gauges_each; ++k) {
      const Gauge& gauge = line.gauges[gauges_each * i + k];
      const float now = (places[static_cast<std::size_t>(gauge.from)] -
                         places[static_cast<std::size_t>(gauge.to)])
                            .norm();
      surplus[i] = std::max(surplus[i], (1 - fold.onset) * gauge.rest_mm - now);
    }
  for (int pass = 0; pass < smoothing_passes; ++pass) {
    const std::vector<float> before = surplus;
    for (std::size_t i = 0; i < n; ++i)
      surplus[i] = 0.25f * before[i > 0 ? i - 1 : 0] + 0.5f * before[i] +
                   0.25f * before[std::min(i + 1, n - 1)];
  }
  const auto largest = std::max_element(surplus.begin(), surplus.end());
  for (auto own = surplus.begin(); own != largest; ++own)
    *own = std::max(*own, fold.continued * *largest);
  for (std::size_t i = 0; i < n; ++i) {
    const float asked = fold.gain * surplus[i];
    depth[i] = fold.samples[i].fraction * fold.limit_mm * (1 - std::exp(-asked / fold.limit_mm));
  }
  return depth;
}

std::vector<SkinFolds::Shade> SkinFolds::apply(std::vector<Vector3f>& places) const {
  std::vector<std::vector<float>> depth;
  bool folded = false;
  for (const Line& line : lines_) {
    depth.push_back(depths(line, places));
    folded |= std::any_of(depth.back().begin(), depth.back().end(), [](float d) { return d > 0; });
  }
  if (!folded) return {};
  std::vector<Vector3f> normals(vertices_.size(), Vector3f::Zero());
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const auto& t = triangles_[i];
    const Vector3f& a = places[static_cast<std::size_t>(t[0])];
    const Vector3f n = (places[static_cast<std::size_t>(t[1])] - a)
                           .cross(places[static_cast<std::size_t>(t[2])] - a);
    for (int k = 0; k < 3; ++k)
      if (const int own = corners_own_[i][k]; own >= 0) normals[static_cast<std::size_t>(own)] += n;
  }
  for (Vector3f& n : normals) n.normalize();
  // Neighbours that are displaced apart would turn over the slivers between them.
  for (int pass = 0; pass < even_passes; ++pass) {
    const std::vector<Vector3f> before = normals;
    for (const Eigen::Vector3i& own : corners_own_) {
      if (own.minCoeff() < 0) continue;
      for (int k = 0; k < 3; ++k)
        normals[static_cast<std::size_t>(own[k])] +=
            before[static_cast<std::size_t>(own[(k + 1) % 3])];
    }
    for (Vector3f& n : normals) n.normalize();
  }
  std::vector<float> offset(vertices_.size(), 0), dark(vertices_.size(), 0);
  for (const Member& member : members_) {
    const auto& along = depth[static_cast<std::size_t>(member.line)];
    const auto i = std::min(static_cast<std::size_t>(member.along), along.size() - 2);
    const float t = member.along - static_cast<float>(i);
    const float deep = (1 - t) * along[i] + t * along[i + 1];
    const auto own = static_cast<std::size_t>(member.own);
    offset[own] += deep * member.height;
    dark[own] += deep * dark_per_mm * member.dark;
  }
  std::vector<Shade> shades;
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    if (offset[i] == 0) continue;
    places[static_cast<std::size_t>(vertices_[i])] += offset[i] * normals[i];
    if (dark[i] > 0) shades.push_back({vertices_[i], 1 - std::min(dark[i], darkest)});
  }
  return shades;
}

}  // namespace condyle
