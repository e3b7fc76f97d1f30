#pragma once

#include <Eigen/Core>
#include <array>
#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/math/pose.h"
#include "sim/frame/body_tree.h"

namespace condyle {

/// Pose of a body in a list by number; bodies beyond the end of the list are at rest.
inline Pose pose_in(std::span<const Pose> X_CB, BodyId body) {
  return index_of(body) < X_CB.size() ? X_CB[index_of(body)] : Pose{};
}

struct BodyWeight {
  BodyId body;
  double weight = 0;
};

/// Sparse weights of items over the bodies that carry them. The remainder to 1 belongs to the
/// cranium, whose frame of reference is the world.
class BodyWeights {
 public:
  std::size_t size() const { return first_.size() - 1; }
  std::span<const BodyWeight> operator[](std::size_t item) const {
    assert(item < size());
    return std::span(entries_).subspan(first_[item], first_[item + 1] - first_[item]);
  }
  /// Weight of one body, 0 where the item does not list it.
  double of(std::size_t item, BodyId body) const {
    double sum = 0;
    for (const auto& [other, weight] : (*this)[item]) sum += other == body ? weight : 0;
    return sum;
  }

  /// Sum over all bodies except the cranium.
  double sum(std::size_t item) const {
    double sum = 0;
    for (const auto& entry : (*this)[item]) sum += entry.weight;
    return sum;
  }

  /// Appends an item.
  void add(std::span<const BodyWeight> of) {
    for (const auto& entry : of)
      if (entry.weight != 0 && entry.body != cranium_body) entries_.push_back(entry);
    first_.push_back(entries_.size());
  }
  void add(BodyId body, double weight) { add(std::array{BodyWeight{body, weight}}); }

  template <class Archive>
  void fields(Archive& archive) {  // see engine/core/archive.h
    archive(first_, entries_);
  }

 private:
  std::vector<std::size_t> first_{0};
  std::vector<BodyWeight> entries_;
};

/// Displacement of the point X with its bodies, mm.
inline Eigen::Vector3d carried_by(std::span<const BodyWeight> weights, std::span<const Pose> X_CB,
                                  const Eigen::Vector3d& X) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& [body, weight] : weights) sum += weight * (pose_in(X_CB, body) * X - X);
  return sum;
}

/// A vector rotated with its bodies.
inline Eigen::Vector3d turned_by(std::span<const BodyWeight> weights, std::span<const Pose> X_CB,
                                 const Eigen::Vector3d& v) {
  Eigen::Vector3d sum = v;
  for (const auto& [body, weight] : weights) sum += weight * (pose_in(X_CB, body).R * v - v);
  return sum;
}

}  // namespace condyle
