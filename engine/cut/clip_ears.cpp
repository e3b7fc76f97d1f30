#include "engine/cut/clip_ears.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/cut/plane_geometry.h"

namespace condyle {
namespace {

/// The corners of a ring that are not yet cut off. Concave ones lie in a grid, because only they
/// can lie in an ear.
class EarClipper {
 public:
  EarClipper(std::span<const Eigen::Vector2d> points, const std::vector<int>& ring)
      : points_(points), ring_(ring), count_(static_cast<int>(ring.size())) {
    next_.resize(count_);
    previous_.resize(count_);
    concave_.resize(count_);
    alive_.assign(count_, true);
    for (int i = 0; i < count_; ++i) {
      next_[i] = (i + 1) % count_;
      previous_[i] = (i + count_ - 1) % count_;
    }
    low_ = high_ = point(0);
    for (int i = 0; i < count_; ++i) {
      low_ = low_.cwiseMin(point(i));
      high_ = high_.cwiseMax(point(i));
    }
    side_ = std::max(1, static_cast<int>(std::sqrt(count_ / 2.0)));
    cell_ = ((high_ - low_) / side_).cwiseMax(Eigen::Vector2d(1e-9, 1e-9));
    grid_.resize(static_cast<std::size_t>(side_) * side_);
    for (int i = 0; i < count_; ++i) update(i);
  }

  int clip(std::vector<Eigen::Vector3i>& triangles) {
    int forced = 0, left = count_, corner = 0, misses = 0;
    while (left > 3) {
      bool cut = is_ear(corner);
      if (!cut && misses > left) {
        corner = least_bad(corner, left);
        cut = true;
        ++forced;
      }
      if (!cut) {
        corner = next_[corner];
        ++misses;
        continue;
      }
      emit(corner, triangles);
      alive_[corner] = false;
      const int before = previous_[corner], after = next_[corner];
      next_[before] = after;
      previous_[after] = before;
      --left;
      misses = 0;
      update(before);
      update(after);
      corner = next_[after];
    }
    emit(corner, triangles);
    return forced;
  }

 private:
  const Eigen::Vector2d& point(int corner) const { return points_[ring_[corner]]; }
  double ear_area(int corner) const {
    return double_area(point(previous_[corner]), point(corner), point(next_[corner]));
  }
  int cell(double x, int axis) const {
    return std::clamp(static_cast<int>((x - low_[axis]) / cell_[axis]), 0, side_ - 1);
  }

  void update(int corner) {
    const bool was = concave_[corner];
    concave_[corner] = ear_area(corner) <= 0;
    if (concave_[corner] && !was)
      grid_[cell(point(corner).y(), 1) * side_ + cell(point(corner).x(), 0)].push_back(corner);
  }

  bool is_ear(int corner) const {
    const Eigen::Vector2d &a = point(previous_[corner]), &b = point(corner),
                          &c = point(next_[corner]);
    if (double_area(a, b, c) <= 0) return false;
    const Eigen::Vector2d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    for (int y = cell(low.y(), 1); y <= cell(high.y(), 1); ++y)
      for (int x = cell(low.x(), 0); x <= cell(high.x(), 0); ++x)
        for (const int other : grid_[y * side_ + x]) {
          if (!alive_[other] || !concave_[other]) continue;
          const int vertex = ring_[other];
          if (vertex == ring_[previous_[corner]] || vertex == ring_[corner] ||
              vertex == ring_[next_[corner]])
            continue;
          const Eigen::Vector2d& q = points_[vertex];
          if (double_area(a, b, q) >= 0 && double_area(b, c, q) >= 0 && double_area(c, a, q) >= 0)
            return false;
        }
    return true;
  }

  /// Where no ear is free: the flattest corner, a convex one rather than a concave one.
  int least_bad(int start, int left) const {
    int best = start, corner = start;
    double best_value = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < left; ++i, corner = next_[corner]) {
      const double area = ear_area(corner),
                   width = (point(next_[corner]) - point(previous_[corner])).norm() + 1e-30;
      const double value = area > 0 ? -area / width * 1e-3 : area / width;
      if (value <= best_value) continue;
      best_value = value;
      best = corner;
    }
    return best;
  }

  /// A forced ear that repeats a vertex has no area and would leave its neighbours unmatched.
  void emit(int corner, std::vector<Eigen::Vector3i>& triangles) const {
    const int a = ring_[previous_[corner]], b = ring_[corner], c = ring_[next_[corner]];
    if (a != b && b != c && c != a) triangles.push_back({a, b, c});
  }

  std::span<const Eigen::Vector2d> points_;
  const std::vector<int>& ring_;
  int count_, side_ = 1;
  Eigen::Vector2d low_, high_, cell_;
  std::vector<int> next_, previous_;
  std::vector<char> concave_, alive_;
  std::vector<std::vector<int>> grid_;
};

}  // namespace

int clip_ears(std::span<const Eigen::Vector2d> points, const std::vector<int>& ring,
              std::vector<Eigen::Vector3i>& triangles) {
  if (ring.size() < 3) return 0;
  return EarClipper(points, ring).clip(triangles);
}

}  // namespace condyle
