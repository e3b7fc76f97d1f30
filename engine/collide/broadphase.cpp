#include "engine/collide/broadphase.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>

#include <algorithm>
#include <cassert>
#include <mutex>

namespace condyle {
namespace {

constexpr double box_rounding_mm = 1e-9;  // of poses and boxes

/// The body's box along the world's axes.
Box box_at(const Box& box, const Pose& X) {
  const Eigen::Vector3d center = X * box.center();
  const Eigen::Vector3d half = X.R.toRotationMatrix().cwiseAbs() * (0.5 * box.size()) +
                               Eigen::Vector3d::Constant(box_rounding_mm);
  return {center - half, center + half};
}

double gap(const Box& a, const Box& b) {
  return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0).norm();
}

/// FCL would use the box of a sphere around a rotated body; this box is tighter and is set
/// directly.
class Placed final : public fcl::CollisionObjectd {
 public:
  Placed(const std::shared_ptr<fcl::CollisionGeometryd>& shape, int body)
      : CollisionObject(shape), number(body) {}
  void place(const Box& box) { aabb = {box.low, box.high}; }
  int number;
};

/// One tree with its objects. Earlier positions influence the shape of the tree but not its
/// answers.
class Tree {
 public:
  explicit Tree(std::size_t count) {
    const auto shape = std::make_shared<fcl::Sphered>(1);
    for (std::size_t i = 0; i < count; ++i)
      objects_.push_back(std::make_unique<Placed>(shape, static_cast<int>(i)));
  }

  std::vector<BodyPair> near(const std::vector<Box>& boxes, double reach_mm) {
    const Eigen::Vector3d grown = Eigen::Vector3d::Constant(0.5 * reach_mm);
    for (std::size_t i = 0; i < boxes.size(); ++i)
      objects_[i]->place({boxes[i].low - grown, boxes[i].high + grown});
    if (manager_.empty()) {
      std::vector<fcl::CollisionObjectd*> all;
      for (const auto& object : objects_) all.push_back(object.get());
      manager_.registerObjects(all);
      manager_.setup();
    } else {
      manager_.update();
    }
    Found found{boxes, reach_mm, {}};
    manager_.collide(&found, offer);
    std::sort(found.pairs.begin(), found.pairs.end());
    return std::move(found.pairs);
  }

 private:
  struct Found {
    const std::vector<Box>& boxes;
    double reach_mm;
    std::vector<BodyPair> pairs;
  };
  static bool offer(fcl::CollisionObjectd* one, fcl::CollisionObjectd* two, void* data) {
    auto& found = *static_cast<Found*>(data);
    const auto [a, b] =
        std::minmax(static_cast<Placed*>(one)->number, static_cast<Placed*>(two)->number);
    // Expanded boxes overlap slightly beyond the reach where they approach corner to corner.
    if (gap(found.boxes[static_cast<std::size_t>(a)], found.boxes[static_cast<std::size_t>(b)]) <=
        found.reach_mm)
      found.pairs.push_back({a, b});
    return false;
  }

  std::vector<std::unique_ptr<Placed>> objects_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
};

}  // namespace

struct Broadphase::State {
  std::vector<Box> boxes;  // of each body, its own coordinates
  std::mutex mutex;
  std::vector<std::unique_ptr<Tree>> idle;  // as many as threads have queried at the same time
};

Broadphase::Broadphase(std::span<const CollisionMesh* const> bodies)
    : state_(std::make_unique<State>()) {
  for (const CollisionMesh* body : bodies) {
    assert(body);
    state_->boxes.push_back(body->box());
  }
}

Broadphase::~Broadphase() = default;
Broadphase::Broadphase(Broadphase&&) noexcept = default;
Broadphase& Broadphase::operator=(Broadphase&&) noexcept = default;

int Broadphase::body_count() const { return static_cast<int>(state_->boxes.size()); }

std::vector<BodyPair> Broadphase::near(std::span<const Pose> X_WB, double reach_mm) const {
  State& state = *state_;
  assert(X_WB.size() == state.boxes.size() && reach_mm >= 0);
  std::vector<Box> boxes;
  boxes.reserve(X_WB.size());
  for (std::size_t i = 0; i < state.boxes.size(); ++i)
    boxes.push_back(box_at(state.boxes[i], X_WB[i]));

  std::unique_ptr<Tree> tree;
  {
    const std::lock_guard lock(state.mutex);
    if (!state.idle.empty()) {
      tree = std::move(state.idle.back());
      state.idle.pop_back();
    }
  }
  if (!tree) tree = std::make_unique<Tree>(boxes.size());
  std::vector<BodyPair> pairs = tree->near(boxes, reach_mm);
  const std::lock_guard lock(state.mutex);
  state.idle.push_back(std::move(tree));
  return pairs;
}

}  // namespace condyle
