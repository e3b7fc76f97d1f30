#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <vector>

#include "engine/collide/solid.h"
#include "engine/collide/triangle_distance.h"
#include "engine/core/infinity.h"

namespace condyle {
namespace {

constexpr double reach_rounding_mm = 1e-9;
constexpr double touching_mm2 = 1e-20;
constexpr std::size_t max_inside = 500;  // faces examined individually
constexpr int many_faces = 64;           // of a ball: it is divided without a query
constexpr int max_cuts = 6;              // along planes, in a sequence
constexpr double near_sizes = 1;  // deepest middle of a face that is cut, by the size of the face
// Cuts leave this gap to the plane, so that what lies beyond it does not touch the triangle.
constexpr double plane_gap_mm = 1e-5;

}  // namespace

/// Branch-and-bound search for the deepest point of either surface inside the shells of the other.
/// Depth changes by at most one millimetre per millimetre, so an evaluated point bounds its
/// surroundings. Ranges of faces, faces and parts of faces wait in a priority queue; the one with
/// the largest upper bound is divided first, until no bound exceeds the depth found.
class DepthSearch {
 public:
  /// `part`: of B's surface, where contact of the rest of it does not count.
  DepthSearch(const Solid& a, const Solid& b, const SurfacePart* part, const Pose& X_AB,
              const DepthSettings& settings, const CrossingFaces* crossing)
      : settings_(settings),
        sides_{{{(part ? part->faces : b).faces(), a, X_AB, nullptr, {}},
                {a.faces(), b, X_AB.inverse(), part ? &part->tree : nullptr, {}}}},
        crossing_known_(crossing != nullptr) {
    if (crossing_known_) {
      sides_[0].put_crossing(crossing->b);
      sides_[1].put_crossing(crossing->a);
    }
    const bool spreads = crossing_known_ && !has_hidden_piece();
    for (int i = 0; i < 2; ++i)
      for (std::size_t k = 0; k < sides_[i].solid.shells_.size(); ++k)
        if (!spreads || !offer_inside({i, k})) offer_ball({i, k}, 0, {});
    while (!waiting_.empty() && waiting_.top().bound > enough() &&
           evaluations_ < settings_.max_evaluations) {
      const Waiting next = waiting_.top();
      waiting_.pop();
      const Item item = items_[next.item];
      free_.push_back(next.item);
      if (item.ball >= 0)
        divide_ball(item);
      else
        divide_face(item);
    }
  }

  double depth_mm = 0;
  int side = 0;                                        // 0: the point is on B, in A
  Eigen::Vector3d point = Eigen::Vector3d::Zero();     // in the coordinates of the enclosing solid
  Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();  // of that solid at the nearest point

  double error_mm() const {
    return std::max(tolerance(), waiting_.empty() ? 0 : waiting_.top().bound - depth_mm);
  }

 private:
  struct Side {
    const Solid::Faces& surface;
    const Solid& solid;
    Pose X;                              // of the surface in the solid's coordinates
    const TriangleTree* part = nullptr;  // of the solid; only points nearest to it count
    std::vector<int> crossing;           // faces that cross the solid, or its part, ascending
    std::vector<int> corner_place = {};  // per corner: its last place in corner_places_, or -1

    void put_crossing(const std::vector<int>& triangles) {
      for (const int t : triangles) crossing.push_back(surface.slot[t]);
      std::sort(crossing.begin(), crossing.end());
      crossing.erase(std::unique(crossing.begin(), crossing.end()), crossing.end());
    }
    bool crosses(int first, int count) const {
      const auto at = std::lower_bound(crossing.begin(), crossing.end(), first);
      return at != crossing.end() && *at < first + count;
    }
  };
  struct Into {  // a shell of the solid of one side
    int side = 0;
    std::size_t shell = 0;
  };
  /// Result at a point: its depth (negative outside) and the nearest triangle.
  struct Place {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    double depth = -infinity;
    int triangle = -1;
  };
  struct CornerPlace {
    std::size_t shell;
    Place place;
    int earlier;  // of the same corner in another shell; -1: none
  };
  struct Item {
    Into into;
    int ball = -1;       // a range of faces, or
    Triangle face = {};  // a face or a part of one
    Place middle = {};
    bool looked = false;  // a ball's middle has been evaluated; otherwise it is a place nearby
    int across = -1;      // a triangle of the shell that touches the face, if its middle is outside
    int cuts = 0;         // along planes, since it was last halved
  };
  struct Waiting {
    double bound;
    std::size_t item;
    int number;  // ties are broken by age
    bool operator<(const Waiting& other) const {
      return bound != other.bound ? bound < other.bound : number > other.number;
    }
  };

  double tolerance() const { return std::max(settings_.tolerance_mm, 1e-3 * depth_mm); }
  double enough() const { return depth_mm + tolerance(); }
  const Solid::ClosedShell& shell(Into into) const {
    return sides_[into.side].solid.shells_[into.shell];
  }

  /// Whether all faces that cross the solid of the side are known.
  bool knows_all_crossings(Into into) const { return crossing_known_ && !sides_[into.side].part; }

  /// Whether the part that counts may be nearest to some point within `radius` of the place.
  bool may_count(Into into, const Place& place, double radius) const {
    const TriangleTree* part = sides_[into.side].part;
    const double reach = std::abs(place.depth) + 2 * radius + reach_rounding_mm;
    return !part || part->nearest(place.at, reach).triangle >= 0;
  }

  static double radius_about(const Triangle& t, const Eigen::Vector3d& p) {
    return std::max({(t[0] - p).norm(), (t[1] - p).norm(), (t[2] - p).norm()});
  }

  Place look_at(Into into, const Eigen::Vector3d& p, const Place& near) {
    const TriangleTree& tree = shell(into).tree();
    double reach = infinity;  // a known upper bound accelerates the query
    if (near.triangle >= 0)
      reach = (nearest_point(p, tree.corners(near.triangle)) - p).norm() + reach_rounding_mm;
    const SurfacePoint found = tree.signed_nearest(p, reach);
    ++evaluations_;
    return {p, -found.distance, found.triangle};
  }

  /// The same for a point of the surface; keeps the deepest.
  Place look_at_point(Into into, const Eigen::Vector3d& p, const Place& near) {
    const Place place = look_at(into, p, near);
    if (place.depth > depth_mm && may_count(into, place, 0)) {
      depth_mm = place.depth;
      side = into.side;
      point = p;
      const TriangleTree& tree = shell(into).tree();
      outward = tree.pseudonormal(tree.nearest(p, place.depth + reach_rounding_mm));
    }
    return place;
  }

  /// The same for a corner of a face, which its neighbours share: evaluated once for each shell.
  Place look_at_corner(Into into, int face, int k, const Eigen::Vector3d& p, const Place& near) {
    Side& from = sides_[into.side];
    if (from.corner_place.empty()) from.corner_place.assign(from.surface.first_at.size() - 1, -1);
    int& last = from.corner_place[from.surface.corners[face][k]];
    for (int i = last; i >= 0; i = corner_places_[i].earlier)
      if (corner_places_[i].shell == into.shell) {
        ++evaluations_;  // the limit counts them too
        return corner_places_[i].place;
      }
    corner_places_.push_back({into.shell, look_at_point(into, p, near), last});
    last = static_cast<int>(corner_places_.size()) - 1;
    return corner_places_.back().place;
  }

  /// Upper bound of the depth of any point of t. It is at most near.depth plus the distance from
  /// there, and at most the distance to any one triangle of the shell; the latter is largest at a
  /// corner of t and exceeds the depth by a term quadratic in the size of t.
  double bound(Into into, const Triangle& t, const Place& near) const {
    double distance2 = 0;
    for (const auto& corner : t) distance2 = std::max(distance2, (corner - near.at).squaredNorm());
    const double by_distance = near.depth + std::sqrt(distance2);
    if (by_distance <= enough() || near.triangle < 0) return by_distance;
    const Triangle& opposite = shell(into).tree().corners(near.triangle);
    double farthest2 = 0;
    for (const auto& corner : t) {
      farthest2 = std::max(farthest2, (nearest_point(corner, opposite) - corner).squaredNorm());
      if (farthest2 >= by_distance * by_distance) return by_distance;
    }
    return std::sqrt(farthest2);
  }

  /// A triangle of the shell that touches t; -1: none. With one point outside, t then lies entirely
  /// outside.
  int touched(Into into, const Triangle& t) const {
    const Eigen::Vector3d low = t[0].cwiseMin(t[1]).cwiseMin(t[2]).array() - reach_rounding_mm,
                          high = t[0].cwiseMax(t[1]).cwiseMax(t[2]).array() + reach_rounding_mm;
    int found = -1;
    shell(into).tree().any_near(low, high, [&](const Triangle& other, int triangle) {
      const Eigen::Vector3d low_other = other[0].cwiseMin(other[1]).cwiseMin(other[2]),
                            high_other = other[0].cwiseMax(other[1]).cwiseMax(other[2]);
      const bool touches = (low_other.array() <= high.array()).all() &&
                           (high_other.array() >= low.array()).all() &&
                           triangle_distance(t, other, touching_mm2).squared_mm2 < touching_mm2;
      if (touches) found = triangle;
      return touches;
    });
    return found;
  }

  /// Queues an item; all of it lies within `radius` of its middle.
  void wait(double bound, double radius, const Item& item) {
    if (bound > enough() && may_count(item.into, item.middle, radius)) push(bound, item);
  }

  void push(double bound, const Item& item) {
    std::size_t place = items_.size();
    if (free_.empty()) {
      items_.push_back(item);
    } else {
      place = free_.back();
      free_.pop_back();
      items_[place] = item;
    }
    waiting_.push({bound, place, number_++});
  }

  /// Queues a ball; a bound from the place nearby suffices until it is the largest.
  void offer_ball(Into into, int index, const Place& near) {
    const Side& from = sides_[into.side];
    const Solid::Ball& ball = from.surface.balls[index];
    const Eigen::Vector3d middle = from.X * ball.center;
    // A point inside is no deeper than it is in the box.
    double bound = shell(into).box.size().maxCoeff();
    for (int k = 0; k < 3; ++k)
      bound = std::min({bound, middle[k] - shell(into).box.low[k] + ball.radius,
                        shell(into).box.high[k] - middle[k] + ball.radius});
    if (near.triangle >= 0) {
      const Triangle& opposite = shell(into).tree().corners(near.triangle);
      bound = std::min({bound, near.depth + (middle - near.at).norm() + ball.radius,
                        (nearest_point(middle, opposite) - middle).norm() + ball.radius});
    }
    if (bound <= enough()) return;
    if (knows_all_crossings(into) && ball.connected && !from.crosses(ball.first, ball.count) &&
        look_at_point(into, from.X * from.surface.faces[ball.first][0], near).depth <
            -reach_rounding_mm)
      return;
    push(bound, {.into = into, .ball = index, .middle = near});
  }

  void divide_ball(Item item) {
    const Side& from = sides_[item.into.side];
    const Solid::Ball& ball = from.surface.balls[item.ball];
    if (!item.looked && ball.count <= many_faces) {
      item.middle = look_at(item.into, from.X * ball.center, item.middle);
      item.looked = true;
      return wait(item.middle.depth + ball.radius, ball.radius, item);
    }
    if (ball.right != 0) {
      offer_ball(item.into, item.ball + 1, item.middle);
      offer_ball(item.into, ball.right, item.middle);
      return;
    }
    for (int i = ball.first; i < ball.first + ball.count; ++i)
      offer_face(item.into, i, item.middle);
  }

  Triangle face_of(const Side& from, int face) const {
    Triangle t = from.surface.faces[face];
    for (auto& corner : t) corner = from.X * corner;
    return t;
  }

  /// Returns the last item examined.
  Place offer_face(Into into, int index, const Place& near) {
    const Side& from = sides_[into.side];
    const Triangle face = face_of(from, index);
    if (near.triangle >= 0 && bound(into, face, near) <= enough()) return near;
    const Place middle = look_at_middle(into, face, near);
    if (bound(into, face, middle) <= enough()) return middle;
    int across = -1;
    if (middle.depth < -reach_rounding_mm) {
      if (knows_all_crossings(into) && !from.crosses(index, 1)) return middle;
      across = touched(into, face);
      if (across < 0) return middle;
    }
    for (int k = 0; k < 3; ++k) look_at_corner(into, index, k, face[k], middle);
    wait(bound(into, face, middle), radius_about(face, middle.at),
         {.into = into, .face = face, .middle = middle, .across = across});
    return middle;
  }

  /// Whether a connected piece of a surface lies entirely inside a shell that it does not cross.
  bool has_hidden_piece() const {
    for (int i = 0; i < 2; ++i) {
      const Side& from = sides_[i];
      std::vector<bool> crosses(from.surface.piece_face.size(), false);
      for (const int face : from.crossing) crosses[from.surface.piece[face]] = true;
      for (std::size_t piece = 0; piece < crosses.size(); ++piece) {
        if (crosses[piece]) continue;
        const Eigen::Vector3d p = from.X * from.surface.faces[from.surface.piece_face[piece]][0];
        for (const auto& shell : from.solid.shells_)
          if (const double depth = shell.depth(p, 0, infinity);
              depth > -reach_rounding_mm && may_count({i, 0}, {p, depth, -1}, 0))
            return true;
      }
    }
    return false;
  }

  /// Adds the part of a surface inside a shell where no piece is entirely enclosed: the faces that
  /// cross, and the faces connected to them on the inner side. False where that part is large; the
  /// tree of balls is then faster.
  bool offer_inside(Into into) {
    const Side& from = sides_[into.side];
    std::vector<int> inside;
    std::vector<bool> seen(from.surface.faces.size(), false);
    const auto spread = [&](int face, const Place& near) {
      from.surface.each_neighbour(face, [&](int other) {
        if (seen[other] || from.crosses(other, 1)) return;
        seen[other] = true;
        const Triangle t = face_of(from, other);
        const Place corner = look_at_corner(into, other, 0, t[0], near);
        // Where crossings are unknown, a face with a corner outside may still reach inside.
        const double radius = knows_all_crossings(into) ? 0 : radius_about(t, t[0]);
        if (corner.depth >= -radius - reach_rounding_mm && may_count(into, corner, radius))
          inside.push_back(other);
      });
    };
    Place near;
    for (const int face : from.crossing) {
      const Triangle t = face_of(from, face);
      Box box;
      for (const auto& corner : t) box.add(corner);
      if ((box.low.array() > shell(into).box.high.array()).any() ||
          (box.high.array() < shell(into).box.low.array()).any())
        continue;
      near = offer_face(into, face, near);
      spread(face, near);
    }
    for (std::size_t i = 0; i < inside.size(); ++i) {
      if (inside.size() > max_inside) return false;
      near = offer_face(into, inside[i], near);
      spread(inside[i], near);
    }
    return true;
  }

  Place look_at_middle(Into into, const Triangle& t, const Place& near) {
    return look_at_point(into, (t[0] + t[1] + t[2]) / 3, near);
  }

  /// Divides a face along a plane of a triangle of the shell (its own, or through an edge and
  /// upright on it), where the face passes through one, or else in halves. Bounds are exact for the
  /// parts below the triangle, and the parts above it are often outside.
  void divide_face(const Item& item) {
    const Triangle& t = item.face;
    const PlaneCut cut = cut_of(item);
    if (cut.lone < 0) return halve_face(item);
    const int i = cut.lone, k = (i + 1) % 3, l = (i + 2) % 3;
    const auto crossing = [&](int other) -> Eigen::Vector3d {
      return t[i] + (t[other] - t[i]) * (cut.height[i] / (cut.height[i] - cut.height[other]));
    };
    const Eigen::Vector3d p = crossing(k), q = crossing(l);
    for (const Triangle& part :
         {Triangle{t[i], p, q}, Triangle{p, t[k], t[l]}, Triangle{p, t[l], q}})
      offer_part(item, part, item.cuts + 1);
  }

  void halve_face(const Item& item) {
    const Triangle& t = item.face;
    std::size_t longest = 0;
    double length2 = -1;
    for (std::size_t k = 0; k < 3; ++k)
      if (const double l2 = (t[(k + 1) % 3] - t[k]).squaredNorm(); l2 > length2)
        length2 = l2, longest = k;
    const auto &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3];
    const Eigen::Vector3d half = (a + b) / 2;
    look_at_point(item.into, half, item.middle);
    offer_part(item, {a, half, c}, 0);
    offer_part(item, {half, b, c}, 0);
  }

  void offer_part(const Item& item, const Triangle& part, int cuts) {
    if (bound(item.into, part, item.middle) <= enough()) return;
    const Place middle = look_at_middle(item.into, part, item.middle);
    const double most = bound(item.into, part, middle);
    if (most <= enough()) return;
    const int across = middle.depth < -reach_rounding_mm ? touched(item.into, part) : -1;
    if (middle.depth < -reach_rounding_mm && across < 0) return;
    wait(most, radius_about(part, middle.at),
         {.into = item.into, .face = part, .middle = middle, .across = across, .cuts = cuts});
  }

  struct PlaneCut {
    int lone = -1;                 // the corner that is alone on its side; -1: no cut
    std::array<double, 3> height;  // of the corners over the plane
  };
  /// Of the planes that the face passes through, that over which it rises most.
  PlaneCut cut_of(const Item& item) const {
    PlaneCut best;
    const int along = item.across >= 0 ? item.across : item.middle.triangle;
    if (item.cuts == max_cuts || along < 0) return best;
    // Far below its nearest triangle a small face is in reach of many.
    if (item.middle.depth > near_sizes * radius_about(item.face, item.middle.at)) return best;
    const Triangle& opposite = shell(item.into).tree().corners(along);
    const Eigen::Vector3d normal =
        (opposite[1] - opposite[0]).cross(opposite[2] - opposite[0]).normalized();
    double most = tolerance();
    const auto offer = [&](const Eigen::Vector3d& on, const Eigen::Vector3d& upward, double gap) {
      PlaneCut cut;
      int above = 0;
      double highest = 0, lowest = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        cut.height[k] = upward.dot(item.face[k] - on) - gap;
        if (cut.height[k] > 0) ++above;
        highest = std::max(highest, cut.height[k]);
        lowest = std::min(lowest, cut.height[k]);
      }
      if (highest <= most || lowest >= -tolerance()) return;
      most = highest;
      for (int k = 0; k < 3; ++k)
        if ((cut.height[k] > 0) == (above == 1)) cut.lone = k;
      best = cut;
    };
    offer(opposite[0], normal, plane_gap_mm);
    if (item.across >= 0) return best;
    for (std::size_t k = 0; k < 3; ++k)
      offer(opposite[k], (opposite[(k + 1) % 3] - opposite[k]).cross(normal).normalized(), 0);
    return best;
  }

  DepthSettings settings_;
  std::array<Side, 2> sides_;
  bool crossing_known_;
  std::vector<CornerPlace> corner_places_;
  std::vector<Item> items_;
  std::vector<std::size_t> free_;  // slots of items_ for reuse
  std::priority_queue<Waiting> waiting_;
  int evaluations_ = 0, number_ = 0;
};

namespace {

OverlapDepth in_world(const DepthSearch& found, const Pose& X_WA, const Pose& X_WB) {
  OverlapDepth overlap;
  overlap.error_mm = found.error_mm();
  if (found.depth_mm == 0) return overlap;
  const Pose& X = found.side == 0 ? X_WA : X_WB;
  overlap.depth_mm = found.depth_mm;
  overlap.point = X * found.point;
  overlap.normal = found.side == 0 ? X.R * found.outward : X.R * -found.outward;
  return overlap;
}

}  // namespace

OverlapDepth overlap_depth(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                           const DepthSettings& settings, const CrossingFaces* crossing) {
  return in_world({a, b, nullptr, X_WA.inverse() * X_WB, settings, crossing}, X_WA, X_WB);
}

OverlapDepth overlap_depth(const Solid& a, const Pose& X_WA, const Solid& b,
                           const SurfacePart& part_of_b, const Pose& X_WB,
                           const DepthSettings& settings, const CrossingFaces* crossing) {
  return in_world({a, b, &part_of_b, X_WA.inverse() * X_WB, settings, crossing}, X_WA, X_WB);
}

}  // namespace condyle
