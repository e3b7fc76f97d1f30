#include "engine/collide/plain_query.h"

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <cstddef>

#include "engine/collide/fcl_model.h"
#include "engine/collide/shells.h"

namespace condyle {

struct PlainSurface::Tree {
  fcl::BVHModel<fcl::OBBRSSd> model;
};

PlainSurface::PlainSurface(const TriMesh& mesh) {
  require_sound(mesh);
  auto tree = std::make_unique<Tree>();
  build_model(mesh, tree->model);
  tree_ = std::move(tree);
}

PlainSurface::~PlainSurface() = default;

PlainQuery plain_query(const PlainSurface& a, const Pose& X_WA, const PlainSurface& b,
                       const Pose& X_WB, int max_contacts) {
  const auto &model_a = a.tree().model, &model_b = b.tree().model;
  const fcl::Transform3d X_A = fcl_transform(X_WA), X_B = fcl_transform(X_WB);
  const fcl::CollisionRequestd collision(static_cast<std::size_t>(max_contacts), true);
  fcl::CollisionResultd crossing;
  fcl::collide(&model_a, X_A, &model_b, X_B, collision, crossing);
  PlainQuery query;
  query.contacts = static_cast<int>(crossing.numContacts());
  if (query.contacts > 0) return query;
  fcl::DistanceResultd nearest;
  query.distance_mm =
      fcl::distance(&model_a, X_A, &model_b, X_B, fcl::DistanceRequestd(true), nearest);
  return query;
}

}  // namespace condyle
