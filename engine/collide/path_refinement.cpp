#include "engine/collide/path_refinement.h"

#include <algorithm>
#include <cmath>

#include "engine/collide/slide_walk.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double step_mm = 0.5;    // between examined poses, of any point of the body
constexpr double depth_mm = 0.02;  // tolerated, as in contact
constexpr double spacing_mm = 3;   // between poses of the finished path
constexpr int shortcuts = 80, rounds = 12;
constexpr double first_pace_mm = 1, slower = 0.85;

}  // namespace

bool PathChecker::is_free(const Pose& X) {
  ++examined_;
  probe_.look_at(X, 0);
  return probe_.deepest_gap() >= -depth_mm;
}

int PathChecker::steps_between(const Pose& from, const Pose& to, double step) const {
  return std::max(
      1, static_cast<int>(std::ceil(probe_.max_displacement_mm(probe_.between(from, to)) / step)));
}

double PathChecker::free_part(const Pose& from, const Pose& to) {
  const int steps = steps_between(from, to, step_mm);
  for (int k = 1; k <= steps; ++k)
    if (!is_free(interpolate(from, to, static_cast<double>(k) / steps, pivot())))
      return static_cast<double>(k - 1) / steps;
  return 1;
}

double PathChecker::least_gap(const Pose& from, const Pose& to, double limit_mm) {
  const int steps = steps_between(from, to, step_mm);
  double least = limit_mm;
  for (int k = 1; k <= steps; ++k) {
    ++examined_;
    probe_.look_at(interpolate(from, to, static_cast<double>(k) / steps, pivot()), limit_mm);
    least = std::min(least, probe_.deepest_gap());
    if (least < -depth_mm) return least;
  }
  return least;
}

Pose PathChecker::slid(const Pose& from, const Pose& to, double settled_mm) {
  SlideWalk walk(contact_, probe_, from, to, settled_mm);
  const SlideResult result = walk.run();
  examined_ += result.steps;
  return result.X_FM;
}

double PathChecker::distance(const Pose& X, const Pose& to) const {
  const double half = std::min(1., std::abs(X.R.dot(to.R)));
  return std::hypot((X * pivot() - to * pivot()).norm(),
                    2 * std::acos(half) * rotation_length_mm());
}

Pose PathChecker::placed(const Pose& X, const Vector3d& shift, const Vector3d& turn) const {
  Twist x;
  x << shift, turn * rotation_length_mm();
  return probe_.moved(X, x);
}

namespace {

class Refinement {
 public:
  Refinement(std::vector<Pose> poses, PathChecker& checker, PathRandom& random, double margin_mm)
      : poses_(std::move(poses)), checker_(checker), random_(random), margin_mm_(margin_mm) {}

  std::vector<Pose> run() {
    for (int i = 0; i < shortcuts && poses_.size() > 2; ++i) shorten();
    divide();
    double pace_mm = first_pace_mm;
    for (int round = 0; round < rounds; ++round, pace_mm *= slower)
      for (std::size_t i = 1; i + 1 < poses_.size(); ++i)
        if (std::min(gap_[i - 1], gap_[i]) < margin_mm_) widen(i, pace_mm);
    for (int i = 0; i < shortcuts && poses_.size() > 2; ++i) shorten();
    return std::move(poses_);
  }

 private:
  double gap(const Pose& from, const Pose& to) { return checker_.least_gap(from, to, margin_mm_); }

  /// A straight move between two places of the path, where it is free, and once gaps are known as
  /// wide as what it replaces.
  void shorten() {
    const auto place = [&](std::size_t& line) {
      line = random_.index(poses_.size() - 1);
      return interpolate(poses_[line], poses_[line + 1], random_.uniform(), checker_.pivot());
    };
    std::size_t i = 0, k = 0;
    Pose a = place(i), b = place(k);
    if (i == k) return;
    if (i > k) {
      std::swap(i, k);
      std::swap(a, b);
    }
    const auto at = [](auto& list, std::size_t n) { return list.begin() + static_cast<long>(n); };
    double found = 0;
    if (gap_.empty()) {
      if (checker_.free_part(a, b) < 1) return;
    } else {
      found = gap(a, b);
      if (found < *std::min_element(at(gap_, i), at(gap_, k) + 1)) return;
      const double before = gap_[i], after = gap_[k];
      gap_.erase(at(gap_, i), at(gap_, k) + 1);
      gap_.insert(at(gap_, i), {before, found, after});
    }
    poses_.erase(at(poses_, i) + 1, at(poses_, k) + 1);
    poses_.insert(at(poses_, i) + 1, {a, b});
  }

  void divide() {
    std::vector<Pose> fine = {poses_.front()};
    for (std::size_t i = 1; i < poses_.size(); ++i) {
      const double length = checker_.distance(poses_[i - 1], poses_[i]);
      if (length < 1e-6) continue;
      const int parts = static_cast<int>(std::ceil(length / spacing_mm));
      for (int k = 1; k < parts; ++k)
        fine.push_back(interpolate(poses_[i - 1], poses_[i], static_cast<double>(k) / parts,
                                   checker_.pivot()));
      fine.push_back(poses_[i]);
    }
    poses_ = std::move(fine);
    for (std::size_t i = 1; i < poses_.size(); ++i) gap_.push_back(gap(poses_[i - 1], poses_[i]));
  }

  /// Moves one pose by chance where the gap beside it grows.
  void widen(std::size_t i, double pace_mm) {
    const Pose &before = poses_[i - 1], &after = poses_[i + 1];
    const double least = std::min(gap_[i - 1], gap_[i]);
    const Pose shaken = checker_.placed(
        poses_[i], pace_mm * random_.uniform() * random_.direction(),
        pace_mm / checker_.rotation_length_mm() * random_.uniform() * random_.direction());
    const double first = gap(before, shaken);
    if (first <= least) return;
    const double second = gap(shaken, after);
    if (second <= least) return;
    poses_[i] = shaken;
    gap_[i - 1] = first;
    gap_[i] = second;
  }

  std::vector<Pose> poses_;
  std::vector<double> gap_;  // from each pose to the next, at most the margin; empty: unknown
  PathChecker& checker_;
  PathRandom& random_;
  double margin_mm_;
};

}  // namespace

std::vector<Pose> refined_path(std::vector<Pose> poses, PathChecker& checker, PathRandom& random,
                               double margin_mm) {
  return Refinement(std::move(poses), checker, random, margin_mm).run();
}

}  // namespace condyle
