#include "engine/collide/collision_mesh.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/detail/traversal/collision/mesh_collision_traversal_node.h>
#include <fcl/narrowphase/detail/traversal/collision_node.h>
#include <fcl/narrowphase/detail/traversal/distance/mesh_distance_traversal_node.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "engine/collide/triangle_distance.h"

namespace condyle {
namespace {

using Bounds = fcl::OBBRSSd;
using Model = fcl::BVHModel<Bounds>;

// The packaged library was built for 16; a file with wider vector flags would not fit it.
static_assert(alignof(fcl::Transform3d) == 16);

fcl::Transform3d transform(const Pose& X) {
  fcl::Transform3d T = fcl::Transform3d::Identity();
  T.linear() = X.R.toRotationMatrix();
  T.translation() = X.t;
  return T;
}

Triangle corners(const Model& model, int triangle) {
  const fcl::Triangle& t = model.tri_indices[triangle];
  return {model.vertices[t[0]], model.vertices[t[1]], model.vertices[t[2]]};
}

Triangle corners(const Model& model, int triangle, const fcl::Transform3d& X) {
  const fcl::Triangle& t = model.tri_indices[triangle];
  return {X * model.vertices[t[0]], X * model.vertices[t[1]], X * model.vertices[t[2]]};
}

/// FCL walks the two trees and bounds the boxes; pairs of triangles are measured by our own exact
/// distance, because FCL's loses digits, and at times the answer, where edges are parallel. All in
/// A's coordinates.
class NearestPair final : public fcl::detail::MeshDistanceTraversalNodeOBBRSS<double> {
 public:
  NearestPair(const Model& a, const Model& b, const fcl::Transform3d& X, TrianglePair start,
              double bound_mm2)
      : a_(a), b_(b), X_(X), start_(start) {
    best.squared_mm2 = bound_mm2;
    best_mm = std::sqrt(bound_mm2);
    fcl::detail::initialize(*this, a, fcl::Transform3d::Identity(), b, X, request_, result_);
  }

  void preprocess() override {
    if (start_.a >= 0 && start_.a < a_.num_tris && start_.b >= 0 && start_.b < b_.num_tris)
      measure(start_);
  }
  void postprocess() override {}

  void leafTesting(int node_a, int node_b) const override {
    measure({a_.getBV(node_a).primitiveId(), b_.getBV(node_b).primitiveId()});
  }
  bool canStop(double bound_mm) const override { return bound_mm >= best_mm; }

  mutable TriangleGap best;
  mutable double best_mm;
  mutable TrianglePair triangles;

 private:
  void measure(TrianglePair pair) const {
    const TriangleGap gap =
        triangle_distance(corners(a_, pair.a), corners(b_, pair.b, X_), best.squared_mm2);
    if (gap.squared_mm2 >= best.squared_mm2) return;
    best = gap;
    best_mm = std::sqrt(gap.squared_mm2);
    triangles = pair;
  }

  const Model& a_;
  const Model& b_;
  fcl::Transform3d X_;
  TrianglePair start_;
  fcl::DistanceRequestd request_;
  fcl::DistanceResultd result_;
};

/// Collects crossing triangles.
class CrossingPairs final : public fcl::detail::MeshCollisionTraversalNodeOBBRSS<double> {
 public:
  CrossingPairs(const Model& a, const Model& b, const fcl::Transform3d& X, std::size_t max_count)
      : a_(a), b_(b), X_(X), max_count_(max_count) {
    fcl::detail::initialize(*this, a, fcl::Transform3d::Identity(), b, X, request_, result_);
  }

  void leafTesting(int node_a, int node_b) const override {
    const TrianglePair pair{a_.getBV(node_a).primitiveId(), b_.getBV(node_b).primitiveId()};
    const Triangle ta = corners(a_, pair.a), tb = corners(b_, pair.b, X_);
    const TriangleCrossing crossing = triangle_crossing(ta, tb);
    if (!crossing.crosses) return;
    MeshContact contact;
    contact.point = 0.5 * (crossing.from + crossing.to);
    const Eigen::Vector3d na = (ta[1] - ta[0]).cross(ta[2] - ta[0]).normalized();
    const Eigen::Vector3d nb = (tb[1] - tb[0]).cross(tb[2] - tb[0]).normalized();
    const Eigen::Vector3d between = na - nb;
    contact.normal = between.norm() > 1e-6 ? between.normalized() : na;
    if (contact.normal.squaredNorm() < 0.5) contact.normal = Eigen::Vector3d::UnitZ();
    contact.overlap_mm = triangle_overlap(ta, tb);
    contact.triangles = pair;
    found.push_back(contact);
  }
  bool canStop() const override { return found.size() >= max_count_; }

  mutable std::vector<MeshContact> found;

 private:
  const Model& a_;
  const Model& b_;
  fcl::Transform3d X_;
  std::size_t max_count_;
  fcl::CollisionRequestd request_;
  fcl::CollisionResultd result_;
};

}  // namespace

struct CollisionMesh::Tree {
  Model model;
};

CollisionMesh::CollisionMesh(const TriMesh& mesh) : tree_(std::make_unique<Tree>()) {
  assert(!mesh.empty());
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    triangles.emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                           static_cast<std::size_t>(t[2]));
  Model& model = tree_->model;
  model.beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
  model.addSubModel(mesh.vertices, triangles);
  model.endModel();
}

CollisionMesh::~CollisionMesh() = default;
CollisionMesh::CollisionMesh(CollisionMesh&&) noexcept = default;
CollisionMesh& CollisionMesh::operator=(CollisionMesh&&) noexcept = default;

MeshDistance distance(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b,
                      const Pose& X_WB, TrianglePair start) {
  if (start.a < 0 || start.b < 0) start = {0, 0};
  NearestPair nearest(a.tree().model, b.tree().model, transform(X_WA.inverse() * X_WB), start,
                      std::numeric_limits<double>::infinity());
  fcl::detail::distance(&nearest);
  return {nearest.best_mm, X_WA * nearest.best.p, X_WA * nearest.best.q, nearest.triangles};
}

bool touching(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b, const Pose& X_WB,
              TrianglePair start) {
  constexpr double just_above_touch_mm2 = 2e-24;
  NearestPair nearest(a.tree().model, b.tree().model, transform(X_WA.inverse() * X_WB), start,
                      just_above_touch_mm2);
  fcl::detail::distance(&nearest);
  return nearest.best_mm == 0;
}

std::vector<MeshContact> contacts(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b,
                                  const Pose& X_WB, int max_count) {
  CrossingPairs crossing(a.tree().model, b.tree().model, transform(X_WA.inverse() * X_WB),
                         static_cast<std::size_t>(std::max(max_count, 0)));
  if (max_count > 0) fcl::detail::collide(&crossing);
  for (auto& contact : crossing.found) {
    contact.point = X_WA * contact.point;
    contact.normal = X_WA.R * contact.normal;
  }
  return std::move(crossing.found);
}

}  // namespace condyle
