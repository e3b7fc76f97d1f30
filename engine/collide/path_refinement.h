#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "engine/collide/slide_probe.h"

namespace condyle {

/// Random numbers that are the same with every library.
class PathRandom {
 public:
  explicit PathRandom(std::uint64_t seed) : generator_(seed) {}
  double uniform() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }
  std::size_t index(std::size_t count) {
    return std::min(count - 1, static_cast<std::size_t>(uniform() * static_cast<double>(count)));
  }
  Eigen::Vector3d direction() {
    const double z = 2 * uniform() - 1, angle = 2 * std::numbers::pi * uniform(),
                 r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  std::mt19937_64 generator_;
};

/// Examines poses of a body and straight moves between them.
class PathChecker {
 public:
  explicit PathChecker(const SlidingContact& contact) : contact_(contact), probe_(contact, 1) {}

  bool is_free(const Pose& X);
  /// The part of the straight move that is free, in [0, 1].
  double free_part(const Pose& from, const Pose& to);
  /// The smallest gap along it, up to a limit; negative where it is not free.
  double least_gap(const Pose& from, const Pose& to, double limit_mm);
  /// Where the body comes to as it slides towards a target.
  Pose slid(const Pose& from, const Pose& to, double settled_mm);

  /// Displacement of the pivot, and rotation times its length, taken together.
  double distance(const Pose& X, const Pose& to) const;
  Pose placed(const Pose& X, const Eigen::Vector3d& shift, const Eigen::Vector3d& turn) const;
  const Eigen::Vector3d& pivot() const { return contact_.pivot(); }
  double rotation_length_mm() const { return contact_.rotation_length_mm(); }
  int examined() const { return examined_; }

 private:
  int steps_between(const Pose& from, const Pose& to, double step_mm) const;

  const SlidingContact& contact_;
  SlideProbe probe_;
  int examined_ = 0;
};

/// A free path with shorter moves, farther from obstacles.
std::vector<Pose> refined_path(std::vector<Pose> poses, PathChecker& checker, PathRandom& random,
                               double margin_mm);

}  // namespace condyle
