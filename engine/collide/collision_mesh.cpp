#include "engine/collide/collision_mesh.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>

#include "engine/collide/box_tree.h"
#include "engine/collide/plain_query.h"
#include "engine/collide/shells.h"
#include "engine/collide/traversal_front.h"
#include "engine/collide/triangle_distance.h"

namespace condyle {
namespace {

// The packaged library was built with an alignment of 16; wider vector flags would be incompatible.
static_assert(alignof(fcl::Transform3d) == 16);

fcl::Transform3d fcl_transform(const Pose& X) {
  fcl::Transform3d T = fcl::Transform3d::Identity();
  T.linear() = X.R.toRotationMatrix();
  T.translation() = X.t;
  return T;
}

/// Builds the tree of boxes of an empty model.
void build_model(const TriMesh& mesh, fcl::BVHModel<fcl::OBBRSSd>& model) {
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    triangles.emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                           static_cast<std::size_t>(t[2]));
  model.beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
  model.addSubModel(mesh.vertices, triangles);
  model.endModel();
}

struct Surface {
  Surface(const TriMesh& mesh, const std::filesystem::path& cache)
      : vertices(mesh.vertices), triangles(mesh.triangles), tree(BoxTree::stored(mesh, cache)) {}

  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  BoxTree tree;

  bool has(int triangle) const {
    return triangle >= 0 && static_cast<std::size_t>(triangle) < triangles.size();
  }
};

Triangle corners(const Surface& surface, int triangle) {
  const Eigen::Vector3i& t = surface.triangles[static_cast<std::size_t>(triangle)];
  return {surface.vertices[t[0]], surface.vertices[t[1]], surface.vertices[t[2]]};
}

Triangle corners(const Surface& surface, int triangle, const fcl::Transform3d& X) {
  const Eigen::Vector3i& t = surface.triangles[static_cast<std::size_t>(triangle)];
  return {X * surface.vertices[t[0]], X * surface.vertices[t[1]], X * surface.vertices[t[2]]};
}

/// A range of a node's boxes: from..to - 1.
struct ChildRange {
  const BoxPair* boxes;
  int from, to;
  int held(int k) const { return boxes->node[static_cast<std::size_t>(k)]; }
  ChildRange one(int k) const { return {boxes, k, k + 1}; }
};

/// Descends in a pair of boxes that are not both leaves: in both, except where one is much smaller
/// than the other. `boxes_a`, `boxes_b`: of the whole trees.
std::pair<ChildRange, ChildRange> opened(const ChildRange& a, const ChildRange& b,
                                         const BoxPair* boxes_a, const BoxPair* boxes_b) {
  constexpr float much = 4;
  const int held_a = a.held(a.from), held_b = b.held(b.from);
  const float size_a = a.boxes->squared_radius(a.from), size_b = b.boxes->squared_radius(b.from);
  const bool open_a = !holds_triangle(held_a) && (holds_triangle(held_b) || much * size_a > size_b);
  const bool open_b = !holds_triangle(held_b) && (holds_triangle(held_a) || much * size_b > size_a);
  return {open_a ? ChildRange{boxes_a + held_a, 0, 2} : a,
          open_b ? ChildRange{boxes_b + held_b, 0, 2} : b};
}

/// Pairs of boxes, or of triangles, at which a traversal ended.
class Ends {
 public:
  /// `front`: of earlier queries of the kind, or null.
  Ends(const Surface& a, const Surface& b, TraversalFront* front)
      : a_(a.tree.boxes), b_(b.tree.boxes), front_(front) {}

  /// Visits the roots or, where the pose is near that of the last query, the ends of that one
  /// again, except those that `stays` excludes by a lower bound of their gap. Pairs of triangles
  /// are opened; of boxes the gap is evaluated again.
  template <class Stays, class Visit, class Open>
  void traverse(const fcl::Transform3d& X, const Stays& stays, const Visit& visit,
                const Open& open) {
    if (front_ && !front_->begin(a_, b_, X)) front_ = nullptr;
    if (!front_ || front_->at_roots()) {
      visit(ChildRange{a_.data(), 0, 1}, ChildRange{b_.data(), 0, 1});
    } else {
      for (const TraversalFront::End& end : front_->ends()) {
        const ChildRange a = box_of(end.a, a_.data()), b = box_of(end.b, b_.data());
        if (stays(front_->gap_mm(end)))
          front_->keep(end);
        else if (holds_triangle(a.held(a.from)) && holds_triangle(b.held(b.from)))
          open(a, b);
        else
          visit(a, b);
      }
    }
    if (front_) front_->finish();
  }

  /// `gap_mm`: a lower bound.
  void add(const ChildRange& a, int i, const ChildRange& b, int k, double gap_mm) const {
    if (front_) front_->add(index(a, i, a_.data()), index(b, k, b_.data()), gap_mm);
  }

 private:
  static int index(const ChildRange& range, int k, const BoxPair* boxes) {
    return 2 * static_cast<int>(range.boxes - boxes) + k;
  }
  static ChildRange box_of(int end, const BoxPair* boxes) {
    return {boxes + end / 2, end % 2, end % 2 + 1};
  }
  const std::vector<BoxPair>&a_, &b_;
  TraversalFront* front_;
};

/// Surfaces farther apart than this have one dominant direction between them; nearer surfaces (a
/// condyle in its fossa, crowns) are close over an area.
constexpr double facing_mm = 10;
/// Triangles that share a corner are at the same distance, to rounding: those within this margin
/// are compared exactly. Above the distance at which triangles touch.
constexpr double rounding_mm = 2e-12;

/// Traverses the two trees, four pairs of boxes at a time. Pairs of triangles are measured by
/// triangle_distance, because FCL's triangle distance loses digits, and occasionally the answer,
/// where edges are parallel. All in the coordinates of A.
class NearestPair {
 public:
  /// start: the pair measured first, where valid. Only distances below the bound count. front: of
  /// earlier queries of nearest pairs, or null.
  NearestPair(const Surface& a, const Surface& b, const fcl::Transform3d& X, TrianglePair start,
              double bound_mm2, TraversalFront* front = nullptr)
      : a_(a),
        b_(b),
        boxes_a_(a.tree.boxes.data()),
        boxes_b_(b.tree.boxes.data()),
        ends_(a, b, front),
        X_(X),
        turned_(X.linear(), X.translation(), a.tree.reach_mm + b.tree.reach_mm) {
    best.squared_mm2 = bound_mm2;
    best_mm = std::sqrt(bound_mm2);
    if (a_.has(start.a) && b_.has(start.b)) measure(start);
    ends_.traverse(
        X_, [&](double gap_mm) { return gap_mm > best_mm; },
        [&](const auto& in_a, const auto& in_b) { visit(in_a, in_b); },
        [&](const auto& in_a, const auto& in_b) { open(in_a, in_b); });
  }

  TriangleGap best;
  double best_mm;
  TrianglePair triangles;

 private:
  void visit(const ChildRange& a, const ChildRange& b) {
    const auto limit = static_cast<float>(best_mm);
    const bool facing = best_mm > facing_mm;
    FourFloats along;
    if (facing) {
      along = gaps_along(*a.boxes, *b.boxes, direction_, turned_.uncertain_mm);
      bool any = false;
      for (int i = a.from; i < a.to; ++i)
        for (int k = b.from; k < b.to; ++k) {
          any |= along[2 * i + k] < limit;
          if (!(along[2 * i + k] < limit)) ends_.add(a, i, b, k, along[2 * i + k]);
        }
      if (!any) return;
    }
    const FourFloats gaps = gap_bounds(*a.boxes, *b.boxes, turned_);
    // The nearest pair first.
    std::array<int, 4> lanes;
    int count = 0;
    for (int i = a.from; i < a.to; ++i)
      for (int k = b.from; k < b.to; ++k) {
        const int lane = 2 * i + k;
        if (facing && !(along[lane] < limit)) continue;
        int at = count++;
        for (; at > 0 && gaps[lane] < gaps[lanes[at - 1]]; --at) lanes[at] = lanes[at - 1];
        lanes[at] = lane;
      }
    for (int n = 0; n < count; ++n) {
      const int i = lanes[n] / 2, k = lanes[n] % 2;
      if (gaps[lanes[n]] < best_mm)
        open(a.one(i), b.one(k));
      else
        ends_.add(a, i, b, k, gaps[lanes[n]]);
    }
  }
  void open(const ChildRange& a, const ChildRange& b) {
    const int held_a = a.held(a.from), held_b = b.held(b.from);
    if (holds_triangle(held_a) && holds_triangle(held_b))
      return ends_.add(a, a.from, b, b.from,
                       measure({held_triangle(held_a), held_triangle(held_b)}));
    const auto [in_a, in_b] = opened(a, b, boxes_a_, boxes_b_);
    visit(in_a, in_b);
  }
  /// Returns a lower bound of the distance of the triangles. Of pairs at the same distance, the
  /// answer is the first in the order of the triangles, whatever was measured before.
  double measure(TrianglePair pair) {
    const Triangle in_a = corners(a_, pair.a), in_b = corners(b_, pair.b, X_);
    if (const double along = gap_along(in_a, in_b); along > best_mm) return along;
    const double bound_mm = best_mm + rounding_mm;
    const TriangleGap gap = triangle_distance(in_a, in_b, bound_mm * bound_mm);
    const double gap_mm = std::sqrt(gap.squared_mm2);
    const bool first = std::pair(pair.a, pair.b) < std::pair(triangles.a, triangles.b);
    if (gap.squared_mm2 > best.squared_mm2 ||
        (gap.squared_mm2 == best.squared_mm2 && !(triangles.a >= 0 && first)))
      return gap_mm;
    best = gap;
    best_mm = gap_mm;
    triangles = pair;
    const Eigen::Vector3d between = gap.q - gap.p;
    if (between.squaredNorm() <= 0) return gap_mm;
    across_ = between.normalized();
    direction_ = BoxDirection(across_, X_.linear(), X_.translation());
    return gap_mm;
  }
  /// Lower bound of the gap of two triangles.
  double gap_along(const Triangle& a, const Triangle& b) const {
    double high = across_.dot(a[0]), low = across_.dot(b[0]);
    for (int k = 1; k < 3; ++k) {
      high = std::max(high, across_.dot(a[k]));
      low = std::min(low, across_.dot(b[k]));
    }
    return low - high - turned_.uncertain_mm;
  }

  const Surface& a_;
  const Surface& b_;
  const BoxPair *boxes_a_, *boxes_b_;
  Ends ends_;
  fcl::Transform3d X_;  // of B in A
  BoxTransform turned_;
  // Direction between the nearest points found so far, from A to B: for most of the surroundings it
  // proves a larger distance by itself.
  Eigen::Vector3d across_ = Eigen::Vector3d::Zero();  // unit; zero before the first result
  BoxDirection direction_;
};

/// The same traversal for parts of B that may have met A on their path. All in the coordinates of
/// A, except the path of B.
class PathContactTest {
 public:
  PathContactTest(const Surface& a, const Surface& b, const fcl::Transform3d& X,
                  const BodyPath& path, double min_distance_mm)
      : a_(a),
        b_(b),
        boxes_a_(a.tree.boxes.data()),
        boxes_b_(b.tree.boxes.data()),
        X_(X),
        turned_(X.linear(), X.translation(), a.tree.reach_mm + b.tree.reach_mm),
        path_(path),
        min_distance_mm_(min_distance_mm) {}

  bool found() const { return visit({boxes_a_, 0, 1}, {boxes_b_, 0, 1}); }
  bool found_at(TrianglePair pair) const {
    if (!a_.has(pair.a) || !b_.has(pair.b)) return false;
    double longest = 0;
    for (const Eigen::Vector3d& p : corners(b_, pair.b))
      longest = std::max(longest, path_.length(p));
    const double reach = longest + min_distance_mm_;
    const double gap2 =
        triangle_distance(corners(a_, pair.a), corners(b_, pair.b, X_), reach * reach).squared_mm2;
    return gap2 < reach * reach;
  }

 private:
  bool visit(const ChildRange& a, const ChildRange& b) const {
    const FourFloats gaps = gap_bounds(*a.boxes, *b.boxes, turned_);
    for (int k = b.from; k < b.to; ++k) {
      const double reach = longest(b, k) + min_distance_mm_;
      for (int i = a.from; i < a.to; ++i)
        if (!(static_cast<double>(gaps[2 * i + k]) > reach) && open(a.one(i), b.one(k)))
          return true;
    }
    return false;
  }
  bool open(const ChildRange& a, const ChildRange& b) const {
    const int held_a = a.held(a.from), held_b = b.held(b.from);
    if (holds_triangle(held_a) && holds_triangle(held_b))
      return found_at({held_triangle(held_a), held_triangle(held_b)});
    const auto [in_a, in_b] = opened(a, b, boxes_a_, boxes_b_);
    return visit(in_a, in_b);
  }
  /// Upper bound of the path length of any point of a box.
  double longest(const ChildRange& b, int k) const {
    const auto which = static_cast<std::size_t>(k);
    const auto& center = b.boxes->center;
    const double radius = std::sqrt(static_cast<double>(b.boxes->squared_radius(k)));
    return path_.length({center[0][which], center[1][which], center[2][which]}, radius) +
           static_cast<double>(turned_.uncertain_mm);
  }

  const Surface& a_;
  const Surface& b_;
  const BoxPair *boxes_a_, *boxes_b_;
  fcl::Transform3d X_;  // of B in A
  BoxTransform turned_;
  const BodyPath& path_;
  double min_distance_mm_;
};

/// Collects crossing triangles, in each region of A at most `per_region`. The same traversal; in
/// the coordinates of A.
class CrossingPairs {
 public:
  /// front: of earlier queries of crossings, or null; only where no region is limited.
  CrossingPairs(const Surface& a, const Surface& b, const fcl::Transform3d& X, ContactLimits limits,
                TraversalFront* front)
      : a_(a),
        b_(b),
        boxes_a_(a.tree.boxes.data()),
        boxes_b_(b.tree.boxes.data()),
        ends_(a, b, front),
        X_(X),
        turned_(X.linear(), X.translation(), a.tree.reach_mm + b.tree.reach_mm),
        total_(static_cast<std::size_t>(std::max(limits.total, 0))),
        per_region_(limits.per_region) {
    if (total_ == 0 || per_region_ <= 0) return;
    ends_.traverse(
        X_, [&](double gap_mm) { return gap_mm > 0 || found.size() >= total_; },
        [&](const auto& in_a, const auto& in_b) { visit(in_a, in_b); },
        [&](const auto& in_a, const auto& in_b) { open(in_a, in_b); });
  }

  std::vector<MeshContact> found;

 private:
  void visit(const ChildRange& a, const ChildRange& b) {
    const FourFloats gaps = gap_bounds(*a.boxes, *b.boxes, turned_);
    for (int i = a.from; i < a.to; ++i)
      for (int k = b.from; k < b.to; ++k)
        if (found.size() < total_ && !(gaps[2 * i + k] > 0) && !is_full(a, i))
          open(a.one(i), b.one(k));
        else
          ends_.add(a, i, b, k, gaps[2 * i + k]);
  }
  void open(const ChildRange& a, const ChildRange& b) {
    const int held_a = a.held(a.from), held_b = b.held(b.from);
    if (holds_triangle(held_a) && holds_triangle(held_b))
      return ends_.add(a, a.from, b, b.from,
                       test({held_triangle(held_a), held_triangle(held_b)}, region(a, a.from)));
    const auto [in_a, in_b] = opened(a, b, boxes_a_, boxes_b_);
    visit(in_a, in_b);
  }
  int region(const ChildRange& a, int i) const {
    return a_.tree
        .region[static_cast<std::size_t>(a.boxes - boxes_a_)][static_cast<std::size_t>(i)];
  }
  bool is_full(const ChildRange& a, int i) const {
    const int at = region(a, i);
    return at >= 0 && count_[at] >= per_region_;
  }
  /// Returns a lower bound of the distance of the triangles.
  double test(TrianglePair pair, int at) {
    const Triangle ta = corners(a_, pair.a), tb = corners(b_, pair.b, X_);
    const TriangleCrossing crossing = triangle_crossing(ta, tb);
    if (!crossing.crosses) return crossing.apart_mm;
    const Eigen::Vector3d na = (ta[1] - ta[0]).cross(ta[2] - ta[0]).normalized();
    const Eigen::Vector3d nb = (tb[1] - tb[0]).cross(tb[2] - tb[0]).normalized();
    const Eigen::Vector3d between = na - nb;
    MeshContact contact;
    contact.point = 0.5 * (crossing.from + crossing.to);
    contact.normal = between.norm() > 1e-6 ? between.normalized() : na;
    if (contact.normal.squaredNorm() < 0.5) contact.normal = Eigen::Vector3d::UnitZ();
    contact.triangles = pair;
    found.push_back(contact);
    if (at >= 0) ++count_[at];
    return 0;
  }

  const Surface& a_;
  const Surface& b_;
  const BoxPair *boxes_a_, *boxes_b_;
  Ends ends_;
  fcl::Transform3d X_;  // of B in A
  BoxTransform turned_;
  std::size_t total_;
  int per_region_;
  std::array<int, BoxTree::region_count> count_{};
};

}  // namespace

struct CollisionMesh::Tree : Surface {
  using Surface::Surface;
};

CollisionMesh::CollisionMesh(const TriMesh& mesh, const std::filesystem::path& cache) {
  require_sound(mesh);
  tree_ = std::make_unique<Tree>(mesh, cache);
  for (const auto& t : mesh.triangles)
    for (const int v : t) box_.add(mesh.vertices[static_cast<std::size_t>(v)]);
}

CollisionMesh::~CollisionMesh() = default;
CollisionMesh::CollisionMesh(CollisionMesh&&) noexcept = default;
CollisionMesh& CollisionMesh::operator=(CollisionMesh&&) noexcept = default;

namespace {

/// A front of the cache while a query uses it; null without a cache, or where another uses it.
class FrontInUse {
 public:
  FrontInUse(PairCache* cache, TraversalFront PairCache::*front) {
    if (!cache) return;
    lock_ = std::unique_lock(cache->in_use, std::try_to_lock);
    if (lock_) front_ = &(cache->*front);
  }
  TraversalFront* get() const { return front_; }

 private:
  std::unique_lock<std::mutex> lock_;
  TraversalFront* front_ = nullptr;
};

}  // namespace

MeshDistance distance(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b,
                      const Pose& X_WB, TrianglePair start, PairCache* cache) {
  if (start.a < 0 || start.b < 0) start = {0, 0};
  const FrontInUse front(cache, &PairCache::nearest);
  const NearestPair nearest(a.tree(), b.tree(), fcl_transform(X_WA.inverse() * X_WB), start,
                            std::numeric_limits<double>::infinity(), front.get());
  return {nearest.best_mm, X_WA * nearest.best.p, X_WA * nearest.best.q, nearest.triangles};
}

std::optional<MeshDistance> distance_within(double reach_mm, const CollisionMesh& a,
                                            const Pose& X_WA, const CollisionMesh& b,
                                            const Pose& X_WB, TrianglePair start,
                                            PairCache* cache) {
  const FrontInUse front(cache, &PairCache::nearest);
  const NearestPair nearest(a.tree(), b.tree(), fcl_transform(X_WA.inverse() * X_WB), start,
                            reach_mm * reach_mm, front.get());
  if (nearest.triangles.a < 0) return std::nullopt;
  return MeshDistance{nearest.best_mm, X_WA * nearest.best.p, X_WA * nearest.best.q,
                      nearest.triangles};
}

double triangle_gap(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b,
                    const Pose& X_WB, TrianglePair triangles) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  if (!a.tree().has(triangles.a) || !b.tree().has(triangles.b)) return infinite;
  const TriangleGap gap = triangle_distance(
      corners(a.tree(), triangles.a),
      corners(b.tree(), triangles.b, fcl_transform(X_WA.inverse() * X_WB)), infinite);
  return std::sqrt(gap.squared_mm2);
}

bool touching(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b, const Pose& X_WB,
              TrianglePair start) {
  constexpr double just_above_touch_mm2 = 2e-24;
  const NearestPair nearest(a.tree(), b.tree(), fcl_transform(X_WA.inverse() * X_WB), start,
                            just_above_touch_mm2);
  return nearest.best_mm == 0;
}

bool clear_on_path(const CollisionMesh& stays, const Pose& X_WS, const CollisionMesh& moves,
                   const Pose& X_WM, const BodyPath& path, double min_distance_mm,
                   TrianglePair start) {
  const PathContactTest met(stays.tree(), moves.tree(), fcl_transform(X_WS.inverse() * X_WM), path,
                            min_distance_mm);
  return !met.found_at(start) && !met.found();
}

std::vector<MeshContact> contacts(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b,
                                  const Pose& X_WB, ContactLimits limits, PairCache* cache) {
  const FrontInUse front(limits.per_region < limits.total ? nullptr : cache, &PairCache::crossing);
  CrossingPairs crossing(a.tree(), b.tree(), fcl_transform(X_WA.inverse() * X_WB), limits,
                         front.get());
  for (auto& contact : crossing.found) {
    contact.point = X_WA * contact.point;
    contact.normal = X_WA.R * contact.normal;
  }
  return std::move(crossing.found);
}

double overlap(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b, const Pose& X_WB,
               TrianglePair triangles) {
  return triangle_overlap(corners(a.tree(), triangles.a),
                          corners(b.tree(), triangles.b, fcl_transform(X_WA.inverse() * X_WB)));
}

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
