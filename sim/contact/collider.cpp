#include "sim/contact/collider.h"

#include <algorithm>
#include <cmath>

#include "engine/core/hash.h"

namespace condyle {
namespace {

// Number of crossing triangles collected: all (arches in full bite have several thousand) where the
// depth is measured by them, else a few from each part of the surface.
constexpr ContactLimits all_crossings{.total = 8192, .per_region = 8192};
constexpr ContactLimits some_crossings{.total = 1024, .per_region = 8};
// Up to this many crossings are listed before the search for the depth, which they make faster; a
// longer list costs more than it saves (bench collide, recorded overlap).
constexpr ContactLimits light_contact{.total = 256, .per_region = 256};
constexpr ContactLimits any_crossing{.total = 1, .per_region = 1};
// Below this the search is fast without them.
constexpr std::size_t many_faces = 2000;
// Where the nearest triangles of an earlier pose are as near as this, surfaces probably cross.
constexpr double probably_crossing_mm = 0.3;
// Surfaces farther apart do not touch: well above the rounding of a distance.
constexpr double touching_reach_mm = 1e-3;
// Teeth modelled with a millimetre of overlap must not excuse a condyle from its fossa.
constexpr double excused_mm = 10;

/// `count` of the contacts, spread evenly over their order.
std::vector<ContactPoint> thin(const std::vector<MeshContact>& all, int count) {
  std::vector<ContactPoint> kept;
  const std::size_t number = std::min(all.size(), static_cast<std::size_t>(std::max(count, 0)));
  kept.reserve(number);
  for (std::size_t i = 0; i < number; ++i) {
    const MeshContact& contact = all[i * all.size() / number];
    kept.push_back({contact.point, contact.normal});
  }
  return kept;
}

PairContact about(const ColliderPair& pair) {
  PairContact out;
  out.part_a = pair.a->part;
  out.part_b = pair.b->part;
  out.policy = pair.policy;
  out.rest_depth_mm = pair.rest_depth_mm;
  return out;
}

/// The crossings, or some, of surfaces that probably cross: found in less time than the distance,
/// which is then 0.
std::vector<MeshContact> early_crossings(const ColliderPair& pair, const Pose& X_CA,
                                         const Pose& X_CB, TrianglePair start,
                                         const QueryOptions& options) {
  const CollisionMesh &a = pair.a->surface, &b = pair.b->surface;
  if (pair.a->solid.face_count() + pair.b->solid.face_count() <= many_faces ||
      !(triangle_gap(a, X_CA, b, X_CB, start) < probably_crossing_mm))
    return {};
  return contacts(a, X_CA, b, X_CB, options.need_depth ? light_contact : any_crossing,
                  pair.cache.get());
}

}  // namespace

namespace {

std::uint64_t hash_of(const TriMesh& mesh) {
  std::uint64_t hash = hash_start;
  for (const auto& v : mesh.vertices) hash = hash_bytes(v.data(), 3 * sizeof(double), hash);
  for (const auto& t : mesh.triangles) hash = hash_bytes(t.data(), 3 * sizeof(int), hash);
  return hash;
}

}  // namespace

ColliderShape::ColliderShape(const TriMesh& mesh, const std::filesystem::path& cache)
    : mesh_hash(hash_of(mesh)), surface(mesh, cache), solid(mesh) {}

std::shared_ptr<const ColliderShape> ColliderShape::of(
    const TriMesh& mesh, std::span<const std::shared_ptr<const ColliderShape>> earlier,
    const std::filesystem::path& cache) {
  if (!earlier.empty()) {
    const std::uint64_t hash = hash_of(mesh);
    for (const auto& shape : earlier)
      if (shape->mesh_hash == hash && shape->solid.face_count() == mesh.triangles.size())
        return shape;
  }
  return std::make_shared<const ColliderShape>(mesh, cache);
}

PairContact far_apart(const ColliderPair& pair, double at_least_mm) {
  PairContact out = about(pair);
  out.distance_mm = at_least_mm;
  out.distance_is_bound = true;
  return out;
}

PairContact query_pair(const ColliderPair& pair, const Pose& X_CA, const Pose& X_CB,
                       TrianglePair start, const QueryOptions& options, OverlapDepth* deepest_out) {
  const Collider &a = *pair.a, &b = *pair.b;
  PairContact out = about(pair);
  const double balls_apart = (X_CB * b.solid.center() - X_CA * a.solid.center()).norm() -
                             a.solid.radius() - b.solid.radius();
  bool enclosed = false;
  std::vector<MeshContact> early = early_crossings(pair, X_CA, X_CB, start, options);
  if (!early.empty()) {
    const MeshContact& first = early.front();
    out.distance_mm = 0;
    out.witness_a = out.witness_b = first.point;
    out.triangle_a = first.triangles.a;
    out.triangle_b = first.triangles.b;
  } else {
    const double reach_mm = options.need_distance ? options.far_mm : touching_reach_mm;
    const auto found =
        reach_mm < nowhere_mm
            ? distance_within(reach_mm, a.surface, X_CA, b.surface, X_CB, start, pair.cache.get())
            : distance(a.surface, X_CA, b.surface, X_CB, start, pair.cache.get());
    enclosed = !(found && found->distance_mm == 0) && balls_apart <= 0 &&
               one_encloses_other(a.solid, X_CA, b.solid, X_CB);
    if (!found && !enclosed) return far_apart(pair, std::max(reach_mm, balls_apart));
    MeshDistance gap;
    gap.distance_mm = reach_mm;
    if (found) gap = *found;
    out.distance_mm = gap.distance_mm;
    out.witness_a = gap.witness_a;
    out.witness_b = gap.witness_b;
    out.triangle_a = gap.triangles.a;
    out.triangle_b = gap.triangles.b;
  }
  const bool crossing = out.distance_mm == 0;
  if (!crossing && !enclosed) return out;

  out.touching = true;
  out.distance_mm = 0;
  if (!options.need_depth) return out;
  std::vector<MeshContact> light;
  CrossingFaces crossing_faces;
  bool is_light = crossing && a.solid.face_count() + b.solid.face_count() > many_faces;
  if (is_light) {
    light = early.empty()
                ? contacts(a.surface, X_CA, b.surface, X_CB, light_contact, pair.cache.get())
                : std::move(early);
    is_light = light.size() < static_cast<std::size_t>(light_contact.total);
    for (const auto& contact : light) {
      crossing_faces.a.push_back(contact.triangles.a);
      crossing_faces.b.push_back(contact.triangles.b);
    }
  }
  const CrossingFaces* known = is_light ? &crossing_faces : nullptr;
  OverlapDepth deepest =
      b.whole ? overlap_depth(a.solid, X_CA, *b.whole, {b.solid, *b.part_tree}, X_CB, {}, known)
              : overlap_depth(a.solid, X_CA, b.solid, X_CB, {}, known);
  out.depth_mm = deepest.depth_mm;
  if (!crossing) {
    out.contacts.push_back({deepest.point, deepest.normal});
    out.witness_a = out.witness_b = deepest.point;
    if (deepest_out) *deepest_out = deepest;
    return out;
  }
  // Open shells have no inside, and edges may cross without a corner inside: then the depth is the
  // longest translation that separates one pair of crossing triangles (bounded by their size).
  const bool by_triangles =
      out.depth_mm == 0 || a.solid.open_shell_count() > 0 || b.inside().open_shell_count() > 0;
  if (by_triangles || options.max_contacts > 0) {
    const auto all = is_light ? std::move(light)
                              : contacts(a.surface, X_CA, b.surface, X_CB,
                                         by_triangles ? all_crossings : some_crossings);
    out.contacts = thin(all, options.max_contacts);
    if (all.empty() && options.max_contacts > 0)  // they touch in a point
      out.contacts.push_back({out.witness_a, deepest.normal});
    if (by_triangles)
      for (const auto& contact : all)
        if (const double depth = overlap(a.surface, X_CA, b.surface, X_CB, contact.triangles);
            depth > deepest.depth_mm)
          deepest = {depth, contact.point, contact.normal};
    out.depth_mm = std::max(out.depth_mm, deepest.depth_mm);
  }
  if (deepest.depth_mm > 0) out.witness_a = out.witness_b = deepest.point;
  if (deepest_out) *deepest_out = deepest;
  return out;
}

std::vector<MeshContact> overlap_at_rest(const ColliderPair& pair) {
  return contacts(pair.a->surface, {}, pair.b->surface, {}, all_crossings);
}

TriMesh away_from_overlap(const TriMesh& mesh, const std::vector<MeshContact>& overlap) {
  std::vector<bool> excused(mesh.triangles.size(), false);
  std::vector<bool> near(mesh.vertices.size(), false);
  for (const auto& contact : overlap) excused[static_cast<std::size_t>(contact.triangles.b)] = true;
  for (std::size_t v = 0; v < near.size(); ++v)
    near[v] = std::any_of(overlap.begin(), overlap.end(), [&](const auto& contact) {
      return (contact.point - mesh.vertices[v]).squaredNorm() < excused_mm * excused_mm;
    });
  TriMesh away{mesh.vertices, {}, {}};
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    if (!excused[i] && !near[t[0]] && !near[t[1]] && !near[t[2]]) away.triangles.push_back(t);
  }
  return away;
}

}  // namespace condyle
