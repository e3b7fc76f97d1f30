#include "sim/dental_scan/crown_points.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/mesh/measure.h"
#include "engine/registration/surface_samples.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double crown_height_mm = 5;  // below the local top
constexpr double arch_height_mm = 10;  // below the highest top: curves of the arch, and its tilt
constexpr double cell_mm = 2.5;        // of the map of heights
constexpr int reach_cells = 2;

/// Greatest height in cells across the bite direction, spread to the cells around.
class HeightMap {
 public:
  HeightMap(const std::vector<SurfaceSample>& samples, const Vector3d& bite)
      : bite_(bite), right_(bite.unitOrthogonal()), up_(bite.cross(right_)) {
    for (const auto& s : samples) {
      const Eigen::Vector2d p = flat(s.point);
      low_ = low_.cwiseMin(p);
      high_ = high_.cwiseMax(p);
    }
    width_ = 1 + static_cast<int>((high_.x() - low_.x()) / cell_mm);
    depth_ = 1 + static_cast<int>((high_.y() - low_.y()) / cell_mm);
    std::vector<double> own(static_cast<std::size_t>(width_ * depth_),
                            -std::numeric_limits<double>::infinity());
    for (const auto& s : samples) {
      double& cell = own[index(s.point)];
      cell = std::max(cell, height(s.point));
      top_ = std::max(top_, height(s.point));
    }
    around_ = own;
    for (int j = 0; j < depth_; ++j)
      for (int i = 0; i < width_; ++i)
        for (int b = std::max(0, j - reach_cells); b <= std::min(depth_ - 1, j + reach_cells); ++b)
          for (int a = std::max(0, i - reach_cells); a <= std::min(width_ - 1, i + reach_cells);
               ++a)
            around_[at(i, j)] = std::max(around_[at(i, j)], own[at(a, b)]);
  }

  bool on_crown(const Vector3d& p) const {
    const double h = height(p);
    return h > top_ - arch_height_mm && h > around_[index(p)] - crown_height_mm;
  }

 private:
  Eigen::Vector2d flat(const Vector3d& p) const { return {right_.dot(p), up_.dot(p)}; }
  double height(const Vector3d& p) const { return bite_.dot(p); }
  std::size_t at(int i, int j) const { return static_cast<std::size_t>(j * width_ + i); }
  std::size_t index(const Vector3d& p) const {
    const Eigen::Vector2d cell = (flat(p) - low_) / cell_mm;
    return at(std::clamp(static_cast<int>(cell.x()), 0, width_ - 1),
              std::clamp(static_cast<int>(cell.y()), 0, depth_ - 1));
  }

  Vector3d bite_, right_, up_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high_ = -low_;
  int width_ = 0, depth_ = 0;
  double top_ = -std::numeric_limits<double>::infinity();
  std::vector<double> around_;
};

}  // namespace

Vector3d flat_normal(const TriMesh& mesh) {
  constexpr int count = 4000;
  const auto samples = sample_surface(mesh, count);
  if (samples.empty()) return Vector3d::UnitZ();
  Vector3d center = Vector3d::Zero();
  for (const auto& s : samples) center += s.point / static_cast<double>(samples.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& s : samples) spread += (s.point - center) * (s.point - center).transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
}

CrownPoints crown_points(const TriMesh& mesh, const Vector3d& bite, int count) {
  constexpr int samples_a_point = 3;
  CrownPoints crowns;
  crowns.bite = bite;
  const auto samples = sample_surface(mesh, samples_a_point * count);
  if (samples.empty()) return crowns;
  const auto normals = vertex_normals(mesh);
  const HeightMap heights(samples, bite);
  OrientedPoints all;
  for (const auto& s : samples) {
    if (!heights.on_crown(s.point)) continue;
    const auto& t = mesh.triangles[static_cast<std::size_t>(s.triangle)];
    Vector3d normal = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) normal += s.barycentric[k] * normals[t[k]];
    if (!(normal.norm() > 0.1)) continue;
    all.points.push_back(s.point);
    all.normals.push_back(normal.normalized());
  }
  crowns.points = all.thinned(static_cast<std::size_t>(count));
  for (const auto& p : crowns.points.points)
    crowns.center += p / static_cast<double>(crowns.points.size());
  return crowns;
}

CrownPoints mirrored(CrownPoints crowns) {
  for (auto& p : crowns.points.points) p.x() = -p.x();
  for (auto& n : crowns.points.normals) n.x() = -n.x();
  crowns.bite.x() = -crowns.bite.x();
  crowns.center.x() = -crowns.center.x();
  return crowns;
}

}  // namespace condyle
