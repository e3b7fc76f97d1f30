#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "engine/collide/collision_mesh.h"
#include "engine/collide/solid.h"
#include "engine/collide/traversal_front.h"
#include "sim/frame/contact_set.h"

namespace condyle {

/// Pose-independent data for queries on one surface; models with the same surface share it.
struct ColliderShape {
  std::uint64_t mesh_hash = 0;
  CollisionMesh surface;
  Solid solid;

  /// `cache`: where the tree of boxes is kept; empty: nowhere.
  explicit ColliderShape(const TriMesh& mesh, const std::filesystem::path& cache = {});
  /// `earlier` if it was made from the same surface, else a new one.
  static std::shared_ptr<const ColliderShape> of(
      const TriMesh& mesh, std::span<const std::shared_ptr<const ColliderShape>> earlier,
      const std::filesystem::path& cache = {});
};

/// A surface that takes part in contact.
struct Collider {
  int number = 0;  // among the model's colliders
  int part = 0;    // index in the case
  BodyId body = cranium_body;
  bool complement = false;  // only the part away from an overlap at rest
  std::shared_ptr<const ColliderShape> shape;
  const CollisionMesh& surface = shape->surface;
  const Solid& solid = shape->solid;
  // For a complement: the solid of which its surface, which is cut open and has no inside, is a
  // part; and a tree of that surface.
  const Solid* whole = nullptr;
  std::unique_ptr<const TriangleTree> part_tree = nullptr;

  const Solid& inside() const { return whole ? *whole : solid; }
};

/// Two colliders of different bodies, and their contact rule.
struct ColliderPair {
  const Collider* a = nullptr;
  const Collider* b = nullptr;
  PairPolicy policy = PairPolicy::forbidden;
  bool apart_at_rest = true;
  double rest_depth_mm = 0;
  // false for two segments that overlap as planned: what overlaps is trimmed in surgery, so it is
  // measured but does not stop a move
  bool obstructs = true;
  double min_distance_mm = 0;  // distance that a guided pair keeps: its gap, or less where it was
                               // less at rest
  std::shared_ptr<PairCache> cache = std::make_shared<PairCache>();  // of the two surfaces
};

/// Surfaces deeper in each other than this at rest are held there by their depth as well as by
/// their shape.
constexpr double deep_mm = 0.1;

constexpr double nowhere_mm = std::numeric_limits<double>::infinity();

/// Requested accuracy of a query.
struct QueryOptions {
  int max_contacts = 0;
  double far_mm = nowhere_mm;  // beyond this a lower bound of the distance suffices
  bool need_depth = true;      // otherwise only whether they touch
  bool need_distance = true;   // otherwise only whether they touch, and how deep
};

/// Result for one pair at one pose. `deepest`: where the depth was measured, if at all.
PairContact query_pair(const ColliderPair& pair, const Pose& X_CA, const Pose& X_CB,
                       TrianglePair start, const QueryOptions& options,
                       OverlapDepth* deepest = nullptr);

/// Result for a pair that is known only to be apart.
PairContact far_apart(const ColliderPair& pair, double at_least_mm);

/// All contacts of a pair at rest.
std::vector<MeshContact> overlap_at_rest(const ColliderPair& pair);

/// The triangles of B that neither cross A at rest nor are near (10 mm) a crossing: overlap in one
/// region must not excuse contact in another.
TriMesh away_from_overlap(const TriMesh& mesh, const std::vector<MeshContact>& overlap);

}  // namespace condyle
