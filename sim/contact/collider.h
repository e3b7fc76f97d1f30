#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "engine/collide/collision_mesh.h"
#include "engine/collide/solid.h"
#include "sim/frame/contact_set.h"

namespace condyle {

/// Bodies by number: the cranium, the mandible, then the free parts in the case's order.
constexpr int cranium_body = 0, mandible_body = 1, first_free_body = 2;

/// One surface that takes part, and the pose-independent queries on it.
struct Collider {
  int number = 0;  // among the model's colliders
  int part = 0;    // index in the case
  int body = cranium_body;
  bool guard = false;  // only of what is away from an overlap at rest
  CollisionMesh surface;
  Solid solid;
};

/// Two colliders of different bodies, and what they may do to each other.
struct ColliderPair {
  const Collider* a = nullptr;
  const Collider* b = nullptr;
  PairPolicy policy = PairPolicy::forbidden;
  bool apart_at_rest = true;
  double rest_depth_mm = 0;
  double kept_mm = 0;  // distance that a guided pair keeps: its gap, or less where it was less at
                       // rest
};

/// Surfaces deeper in each other than this at rest are held there as much by their depth as by
/// their shape.
constexpr double deep_mm = 0.1;

constexpr double nowhere_mm = std::numeric_limits<double>::infinity();

/// How much is to be found out.
struct Looking {
  int max_contacts = 0;
  double far_mm = nowhere_mm;  // beyond this a lower bound of the distance will do
  bool need_depth = true;      // else touching is all that is asked
};

/// Everything about one pair at one pose. `deepest` is where the depth was measured, if at all.
PairContact judge(const ColliderPair& pair, const Pose& X_CA, const Pose& X_CB, TrianglePair start,
                  const Looking& looking, OverlapDepth* deepest = nullptr);

/// A pair of which no more is known than that it is apart.
PairContact far_apart(const ColliderPair& pair, double at_least_mm);

/// Contacts of a pair at rest, all of them.
std::vector<MeshContact> overlap_at_rest(const ColliderPair& pair);

/// The triangles of B that neither cross A at rest nor come near a place that does (10 mm): overlap
/// in one place must not excuse contact in another.
TriMesh away_from_overlap(const TriMesh& mesh, const std::vector<MeshContact>& overlap);

}  // namespace condyle
