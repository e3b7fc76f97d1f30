#pragma once

#include <compare>
#include <memory>
#include <span>
#include <vector>

#include "engine/collide/collision_mesh.h"
#include "engine/math/pose.h"

namespace condyle {

/// Two bodies by number, a < b.
struct BodyPair {
  int a = 0, b = 0;
  auto operator<=>(const BodyPair&) const = default;
};

/// Finds which of many bodies are near enough to each other to be examined: a tree of boxes (FCL's
/// DynamicAABBTreeCollisionManager) that is updated from query to query.
class Broadphase {
 public:
  /// Bodies are numbered in the given order. Only their boxes are stored; the surfaces may be
  /// destroyed.
  explicit Broadphase(std::span<const CollisionMesh* const> bodies);
  ~Broadphase();
  Broadphase(Broadphase&&) noexcept;
  Broadphase& operator=(Broadphase&&) noexcept;

  /// Pairs whose boxes (along the world's axes, around the body's own box) are at most `reach_mm`
  /// (>= 0) apart; sorted. Every pair whose surfaces are that near is among them. shape: one finite
  /// pose per body. The result depends on the arguments alone; several threads may query at the
  /// same time.
  std::vector<BodyPair> near(std::span<const Pose> X_WB, double reach_mm) const;

  int body_count() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
