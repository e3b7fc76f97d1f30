#include "sim/tissue/oral_fissure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "engine/tissue/layered_mesh.h"

namespace condyle {

using Eigen::Vector3d;

namespace {

double height_at(const std::vector<std::pair<double, double>>& run, double x) {
  if (x <= run.front().first) return run.front().second;
  if (x >= run.back().first) return run.back().second;
  for (std::size_t i = 1; i < run.size(); ++i)
    if (x <= run[i].first) {
      const double width = run[i].first - run[i - 1].first;
      const double s = width > 0 ? (x - run[i - 1].first) / width : 0;
      return run[i - 1].second + s * (run[i].second - run[i - 1].second);
    }
  return run.back().second;
}

/// Distance as seen from the front.
double off_corner(const Vector3d& p, const Vector3d& corner) {
  return std::hypot(p.x() - corner.x(), p.z() - corner.z());
}

}  // namespace

OralFissure::OralFissure(const TriMesh& skin, const MouthOutline& mouth) {
  if (!mouth.found()) return;
  right_ = skin.vertices[mouth.right_corner];
  left_ = skin.vertices[mouth.left_corner];
  const auto run = [&](const std::vector<int>& lip) {
    std::vector<std::pair<double, double>> points{{right_.x(), right_.z()}, {left_.x(), left_.z()}};
    for (int v : lip) points.emplace_back(skin.vertices[v].x(), skin.vertices[v].z());
    std::sort(points.begin(), points.end());
    return points;
  };
  const auto upper = run(mouth.upper), lower = run(mouth.lower);
  constexpr int samples = 33;
  for (int i = 0; i < samples; ++i) {
    const double x = right_.x() + (left_.x() - right_.x()) * i / (samples - 1);
    x_.push_back(x);
    z_.push_back(0.5 * (height_at(upper, x) + height_at(lower, x)));
  }
}

double OralFissure::height(const Vector3d& p) const {
  if (!found()) return 1;
  const double at =
      (p.x() - x_.front()) / (x_.back() - x_.front()) * static_cast<double>(x_.size() - 1);
  const double clamped = std::clamp(at, 0.0, static_cast<double>(x_.size() - 1));
  const std::size_t i = std::min(static_cast<std::size_t>(clamped), x_.size() - 2);
  return p.z() - (z_[i] + (clamped - static_cast<double>(i)) * (z_[i + 1] - z_[i]));
}

double OralFissure::distance_from(const Vector3d& p) const {
  if (!found()) return std::numeric_limits<double>::infinity();
  const Vector3d line = left_ - right_;
  const double along = std::clamp((p - right_).dot(line) / line.squaredNorm(), 0.0, 1.0);
  return (p - right_ - along * line).norm();
}

bool OralFissure::at_corner(const Vector3d& p) const {
  constexpr double near_mm = 3;
  return found() && std::min(off_corner(p, right_), off_corner(p, left_)) < near_mm;
}

Vector3d OralFissure::sampled_at(const Vector3d& p, double reach) const {
  if (!found() || reach <= 0) return p;
  const Vector3d& corner = (p - right_).squaredNorm() < (p - left_).squaredNorm() ? right_ : left_;
  const double s = (p - corner).norm() / reach;
  if (s >= 1 || s < 1e-9) return p;
  return corner + (std::sqrt(s) - 0.5 * s + 0.5 * s * s) / s * (p - corner);  // smooth at s = 1
}

double OralFissure::distance(const Vector3d& p, int side_p, const Vector3d& q, int side_q) const {
  const double straight = (p - q).norm();
  if (!found() || side_p == side_q) return straight;
  // Where the straight line crosses the fissure; points whose height contradicts their side (lips
  // that overlap slightly) count as just beside it.
  const double up = std::max(side_p * height(p), 0.01), down = std::max(side_q * height(q), 0.01);
  const double x = p.x() + up / (up + down) * (q.x() - p.x());
  if (x <= x_.front() || x >= x_.back()) return straight;
  // The slit is as wide at any depth: the path bends at the corner only as seen from the front.
  const auto round = [&](const Vector3d& corner) {
    return std::hypot(off_corner(p, corner) + off_corner(q, corner), p.y() - q.y());
  };
  return std::min(round(right_), round(left_));
}

LipSides sides_of(const TriMesh& skin, const MouthOutline& mouth, const OralFissure& fissure,
                  double reach, const std::vector<char>& lining) {
  const std::size_t count = skin.vertices.size();
  LipSides lips{std::vector<signed char>(count),
                std::vector<double>(count, std::numeric_limits<double>::infinity())};
  for (std::size_t v = 0; v < count; ++v)
    lips.side[v] = static_cast<signed char>(fissure.side(skin.vertices[v]));
  if (!mouth.found()) return lips;

  std::vector<std::vector<int>> ring(count);
  for (const auto& [a, b] : edges_of(skin.triangles)) {
    ring[a].push_back(b);
    ring[b].push_back(a);
  }
  std::set<std::pair<double, int>> open;
  const auto start = [&](const std::vector<int>& lip, signed char s) {
    for (int v : lip) {
      lips.side[v] = s;
      lips.to_edge[v] = 0;
      open.insert({0.0, v});
    }
  };
  start(mouth.upper, 1);
  start(mouth.lower, -1);
  while (!open.empty()) {
    const auto [d, v] = *open.begin();
    open.erase(open.begin());
    for (int n : ring[v]) {
      const double next = d + (skin.vertices[n] - skin.vertices[v]).norm();
      if (next >= lips.to_edge[n] || (next > reach && (lining.empty() || !lining[n]))) continue;
      open.erase({lips.to_edge[n], n});
      lips.to_edge[n] = next;
      lips.side[n] = lips.side[v];
      open.insert({next, n});
    }
  }
  return lips;
}

}  // namespace condyle
