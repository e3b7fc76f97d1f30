#include "render/face/cheek_thickness.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/math/smooth_step.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

constexpr float adult_width_mm = 50;  // of the mouth for which lengths are given
constexpr float gauge_step_mm = 8;
constexpr float thickest_mm = 15;
constexpr float share_of_clearance = 0.4f, highest_mm = 4;  // of a hollow, a bulge
constexpr float adult_shade_per_mm = 0.04f, darkest_shade = 0.25f;
constexpr float farthest_back_mm = 52;

/// In front of the masseter.
constexpr CheekThickness::Region buccal{.front = 6,
                                        .full_from = 30,
                                        .full_to = 31,
                                        .back = farthest_back_mm,
                                        .height = 4,
                                        .scale_above = 26,
                                        .scale_below = 17,
                                        .gauge_back = 16,
                                        .gauge_up = -23,
                                        .slack = 0.05f,
                                        .gain = 1,
                                        .sinks = true};
/// Behind the nasolabial fold, below the eye.
constexpr CheekThickness::Region malar{.front = 0,
                                       .full_from = 12,
                                       .full_to = 20,
                                       .back = 42,
                                       .height = 26,
                                       .scale_above = 15,
                                       .scale_below = 15,
                                       .gauge_back = 3,
                                       .gauge_up = 0,
                                       .slack = 0.02f,
                                       .gain = 3,
                                       .sinks = false};

constexpr float least_cosine = 0.3f;  // of skin that is displaced, not the lining
constexpr float full_beside_mm = 8;   // outward from the corner of the mouth, to full effect
constexpr float farthest_mm = 70;     // above or below a height

/// A vertex of a cheek in the directions of a region.
struct CheekPoint {
  int vertex;
  float back, up;  // from the corner of the mouth, over the unit of length
  float facing;    // 0 to 1: to the side and forward, beside the mouth
};

float weight_in(const CheekThickness::Region& region, const CheekPoint& p) {
  const double along = smooth_step((p.back - region.front) / (region.full_from - region.front)) *
                       smooth_step((region.back - p.back) / (region.back - region.full_to));
  const float above = p.up - region.height;
  const float up = above / (above > 0 ? region.scale_above : region.scale_below);
  return p.facing * static_cast<float>(along) * std::exp(-up * up);
}

/// Jaws and teeth within a box.
TriMesh jaws_within(std::span<const Part* const> parts, const Eigen::AlignedBox3d& box) {
  TriMesh jaws;
  for (const Part* part : parts) {
    if (!collides(part->role)) continue;
    for (const Eigen::Vector3i& t : part->mesh.triangles) {
      std::array<Eigen::Vector3d, 3> corners;
      Eigen::AlignedBox3d own;
      for (int k = 0; k < 3; ++k) {
        corners[static_cast<std::size_t>(k)] = part->mesh.vertices[static_cast<std::size_t>(t[k])];
        own.extend(corners[static_cast<std::size_t>(k)]);
      }
      if (!box.intersects(own)) continue;
      const auto first = static_cast<int>(jaws.vertices.size());
      jaws.vertices.insert(jaws.vertices.end(), corners.begin(), corners.end());
      jaws.triangles.emplace_back(first, first + 1, first + 2);
    }
  }
  return jaws;
}

/// The skin beside a corner of the mouth. side: 1 left, -1 right.
std::vector<CheekPoint> cheek_points(std::span<const Vector3f> rest,
                                     std::span<const Vector3f> normals, const Vector3f& corner,
                                     float side, float unit) {
  std::vector<CheekPoint> points;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    const Vector3f off = (rest[v] - corner) / unit;
    const float out = side * off.x(), cosine = normals[v].dot(Vector3f(0.7f * side, -0.7f, 0));
    if (out < 0 || off.y() < -10 || std::abs(off.z() - buccal.height) > farthest_mm ||
        cosine < least_cosine)
      continue;
    if (const float back = std::hypot(out, off.y()); back < farthest_back_mm)
      points.push_back({static_cast<int>(v), back, off.z(),
                        static_cast<float>(smooth_step((cosine - least_cosine) / 0.3) *
                                           smooth_step(out / full_beside_mm))});
  }
  return points;
}

}  // namespace

CheekThickness::CheekThickness(std::span<const Vector3f> rest, std::span<const Vector3f> normals,
                               std::span<const int> rim, std::span<const Part* const> parts) {
  if (rim.empty()) return;
  const auto by_x = [&](int a, int b) {
    return rest[static_cast<std::size_t>(a)].x() < rest[static_cast<std::size_t>(b)].x();
  };
  const auto [right, left] = std::minmax_element(rim.begin(), rim.end(), by_x);
  const std::array corners{rest[static_cast<std::size_t>(*left)],
                           rest[static_cast<std::size_t>(*right)]};
  const float unit = (corners[0].x() - corners[1].x()) / adult_width_mm;
  if (unit <= 0) return;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto points = cheek_points(rest, normals, corners[k], k == 0 ? 1.f : -1.f, unit);
    if (points.empty()) continue;
    Eigen::AlignedBox3d box;
    for (const auto& p : points)
      box.extend(rest[static_cast<std::size_t>(p.vertex)].cast<double>());
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(thickest_mm * unit);
    const TriMesh jaws =
        jaws_within(parts, Eigen::AlignedBox3d(box.min() - margin, box.max() + margin));
    if (jaws.triangles.empty()) continue;
    const TriangleTree tree(jaws);
    for (const Region* of : {&buccal, &malar}) {
      const Region& region = *of;
      Cheek cheek{.region = of};
      float weights = 0, thickness = 0;
      Vector3f normal = Vector3f::Zero();
      for (const auto& p : points) {
        const float weight = weight_in(region, p);
        if (weight < 2e-3f) continue;
        const auto v = static_cast<std::size_t>(p.vertex);
        const float clear = std::min(
            static_cast<float>(tree.nearest(rest[v].cast<double>()).distance), thickest_mm * unit);
        cheek.members.push_back(
            {p.vertex, weight, region.sinks ? share_of_clearance * clear : highest_mm * unit});
        weights += weight;
        thickness += weight * clear;
        normal += weight * normals[v];
      }
      if (weights <= 0) continue;
      cheek.thickness_mm = thickness / weights;
      cheek.shade_per_mm = region.sinks ? adult_shade_per_mm / unit : 0;
      for (std::size_t c = 0; c < columns; ++c)
        for (std::size_t r = 0; r < rows; ++r) {
          const float back = region.gauge_back + gauge_step_mm * static_cast<float>(c),
                      up = region.gauge_up + gauge_step_mm * static_cast<float>(r);
          const auto off = [&](const CheekPoint& p) {
            return std::hypot(p.back - back, p.up - up);
          };
          cheek.gauge[c][r] = std::min_element(points.begin(), points.end(),
                                               [&](const CheekPoint& a, const CheekPoint& b) {
                                                 return off(a) < off(b);
                                               })
                                  ->vertex;
        }
      cheek.rest = extents(cheek, rest);
      if (*std::min_element(cheek.rest.begin(), cheek.rest.end()) <= 0) continue;
      cheek.outward = gauge_normal(cheek, rest).dot(normal) < 0 ? -1.f : 1.f;
      cheeks_.push_back(std::move(cheek));
    }
  }
}

Vector3f CheekThickness::gauge_normal(const Cheek& cheek, std::span<const Vector3f> places) {
  const std::size_t used = cheek.region->sinks ? columns - 1 : columns;
  Vector3f up = Vector3f::Zero(), back = Vector3f::Zero();
  for (std::size_t c = 0; c < used; ++c)
    up += cheek.at(places, c, rows - 1) - cheek.at(places, c, 0);
  for (std::size_t r = 0; r < rows; ++r)
    back += cheek.at(places, used - 1, r) - cheek.at(places, 0, r);
  return up.cross(back).normalized();
}

std::vector<float> CheekThickness::extents(const Cheek& cheek, std::span<const Vector3f> places) {
  std::vector<float> sums;
  for (std::size_t c = 0; c + 1 < columns; ++c) {
    float sum = 0;
    for (std::size_t r = 0; r + 1 < rows; ++r)
      sum += cheek.region->sinks
                 ? (cheek.at(places, c, r + 1) - cheek.at(places, c, r)).norm()
                 : 0.5f * (cheek.at(places, c + 1, r + 1) - cheek.at(places, c, r))
                              .cross(cheek.at(places, c, r + 1) - cheek.at(places, c + 1, r))
                              .norm();
    sums.push_back(sum);
  }
  return sums;
}

std::vector<SkinFolds::Shade> CheekThickness::apply(std::vector<Vector3f>& places) const {
  std::vector<SkinFolds::Shade> shades;
  for (const Cheek& cheek : cheeks_) {
    const Region& region = *cheek.region;
    const auto now = extents(cheek, places);
    float stretch = 0;
    for (std::size_t i = 0; i < now.size(); ++i)
      stretch += now[i] / cheek.rest[i] / static_cast<float>(now.size());
    const float sign = region.sinks ? -1.f : 1.f;
    const float excess = sign * (1 - stretch) - region.slack;
    if (excess <= 0) continue;
    const float change = region.gain * cheek.thickness_mm * excess / (1 - sign * excess);
    const Vector3f direction = sign * cheek.outward * gauge_normal(cheek, places);
    for (const Member& member : cheek.members) {
      const float asked = change * member.weight;
      if (asked <= 0 || member.limit_mm <= 0) continue;
      const float moved = asked * member.limit_mm / std::hypot(asked, member.limit_mm);
      places[static_cast<std::size_t>(member.vertex)] += moved * direction;
      if (cheek.shade_per_mm > 0)
        shades.push_back({member.vertex, 1 - std::min(cheek.shade_per_mm * moved, darkest_shade)});
    }
  }
  return shades;
}

}  // namespace condyle
