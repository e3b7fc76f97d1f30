#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Area normal · x / |x|^3 of a small face at x, up to second order in the point it is seen from.
class FarFaces {
 public:
  void add(const Vector3d& normal, const Vector3d& x) {
    const double r2 = x.squaredNorm(), r3 = r2 * std::sqrt(r2), r5 = r3 * r2;
    const double along = normal.dot(x);
    value_ += along / r3;
    gradient_ += normal / r3 - (3 * along / r5) * x;
    const Matrix3d mixed = normal * x.transpose();
    curvature_ += (15 * along / (r5 * r2)) * x * x.transpose() -
                  (3 / r5) * (mixed + mixed.transpose() + along * Matrix3d::Identity());
  }
  double operator()(const Vector3d& shift) const {
    return value_ - gradient_.dot(shift) + 0.5 * shift.dot(curvature_ * shift);
  }

 private:
  double value_ = 0;
  Vector3d gradient_ = Vector3d::Zero();
  Matrix3d curvature_ = Matrix3d::Zero();
};

/// A sum of solid angles. Half angles are the arguments of complex numbers: while these stay within
/// a right angle their product keeps the sum, so that few arguments have to be found.
class SolidAngles {
 public:
  /// source: van Oosterom and Strackee 1983.
  void add(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    const double y = a.dot(b.cross(c));
    const double x = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    if (!(x > 0)) {
      if (x != 0 || y != 0) sum_ += 2 * std::atan2(y, x);
      return;
    }
    const double scale = 1 / (x + std::abs(y)), u = x * scale, v = y * scale;
    const double real = real_ * u - imaginary_ * v;
    imaginary_ = real_ * v + imaginary_ * u;
    real_ = real;
    if (!(real_ > 1e-100)) flush();
  }
  double sum() {
    flush();
    return sum_;
  }

 private:
  void flush() {
    sum_ += 2 * std::atan2(imaginary_, real_);
    real_ = 1;
    imaginary_ = 0;
  }
  double sum_ = 0, real_ = 1, imaginary_ = 0;
};

}  // namespace

void TriangleTree::winding_numbers(const Vector3d& center, double radius,
                                   std::span<const Vector3d> points,
                                   std::span<double> found) const {
  constexpr double far = 3;     // in radii of a cluster, from every point
  constexpr double series = 6;  // in radii of the points
  struct Dipole {
    Vector3d normal, center;
  };
  thread_local std::vector<Dipole> dipoles;
  thread_local std::vector<int> slots, stack;
  dipoles.clear();
  slots.clear();
  stack.assign(empty() ? 0 : 1, 0);
  FarFaces sum;
  /// Whether a cluster is far enough to count as a point.
  const auto add = [&](const Vector3d& normal, const Vector3d& middle, double extent) {
    const Vector3d away = middle - center;
    const double distance = away.norm();
    if (distance <= far * extent + radius) return false;
    if (distance > series * radius)
      sum.add(normal, away);
    else
      dipoles.push_back({normal, middle});
    return true;
  };
  while (!stack.empty()) {
    const int index = stack.back();
    stack.pop_back();
    const Cluster& cluster = clusters_[index];
    if (add(cluster.area_normal, cluster.center, cluster.radius)) continue;
    const Node& node = nodes_[index];
    if (node.count == 0) {
      stack.push_back(node.first);
      stack.push_back(index + 1);
      continue;
    }
    for (int s = node.first; s < node.first + node.count; ++s) {
      const auto& c = corners_[s];
      const Vector3d middle = (c[0] + c[1] + c[2]) / 3;
      const double extent =
          std::sqrt(std::max({(c[0] - middle).squaredNorm(), (c[1] - middle).squaredNorm(),
                              (c[2] - middle).squaredNorm()}));
      if (!add(0.5 * (c[1] - c[0]).cross(c[2] - c[0]), middle, extent)) slots.push_back(s);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3d& p = points[i];
    double total = sum(p - center);
    for (const auto& [normal, middle] : dipoles) {
      const Vector3d away = middle - p;
      const double r2 = away.squaredNorm();
      total += normal.dot(away) / (r2 * std::sqrt(r2));
    }
    SolidAngles angles;
    for (const int s : slots)
      angles.add(corners_[s][0] - p, corners_[s][1] - p, corners_[s][2] - p);
    found[i] = (total + angles.sum()) / (4 * std::numbers::pi);
  }
}

}  // namespace condyle
