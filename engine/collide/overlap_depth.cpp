#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <set>
#include <vector>

#include "engine/collide/solid.h"
#include "engine/collide/triangle_distance.h"
#include "engine/core/infinity.h"

namespace condyle {
namespace {

constexpr double reach_rounding_mm = 1e-9;
constexpr double touching_mm2 = 1e-20;
constexpr std::size_t most_inside = 500;  // faces to look at one by one

}  // namespace

/// Looks for the deepest point of either surface inside the shells of the other. Depth changes by
/// at most a millimetre per millimetre, so that what has been looked at bounds what is around it.
/// Runs of faces, faces and parts of faces wait in a heap; what may be deepest is divided first,
/// until nothing may be deeper than what was found.
class DepthSearch {
 public:
  DepthSearch(const Solid& a, const Solid& b, const Pose& X_AB, const DepthSettings& settings,
              const CrossingFaces* crossing)
      : settings_(settings),
        sides_{{{b, a, X_AB, {}}, {a, b, X_AB.inverse(), {}}}},
        crossing_known_(crossing != nullptr) {
    if (crossing_known_) {
      sides_[0].put_crossing(crossing->b);
      sides_[1].put_crossing(crossing->a);
    }
    const bool spreads = crossing_known_ && !has_hidden_piece();
    for (int i = 0; i < 2; ++i)
      for (std::size_t k = 0; k < sides_[i].solid.shells_.size(); ++k)
        if (!spreads || !offer_inside({i, k})) offer_ball({i, k}, 0, {});
    while (!waiting_.empty() && waiting_.top().bound > enough() && looks_ < settings_.max_looks) {
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
  Eigen::Vector3d point = Eigen::Vector3d::Zero();     // coordinates of the solid it is in
  Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();  // of that solid, next to it

  double error_mm() const {
    return std::max(tolerance(), waiting_.empty() ? 0 : waiting_.top().bound - depth_mm);
  }

 private:
  struct Side {
    const Solid &surface, &solid;
    Pose X;                     // of the surface in the solid's coordinates
    std::vector<int> crossing;  // faces that cross the solid, ascending

    void put_crossing(const std::vector<int>& triangles) {
      for (const int t : triangles) crossing.push_back(surface.slot_[t]);
      std::sort(crossing.begin(), crossing.end());
      crossing.erase(std::unique(crossing.begin(), crossing.end()), crossing.end());
    }
    bool crosses(int first, int count) const {
      const auto at = std::lower_bound(crossing.begin(), crossing.end(), first);
      return at != crossing.end() && *at < first + count;
    }
  };
  struct Into {  // a shell of one side's solid
    int side = 0;
    std::size_t shell = 0;
  };
  /// What is known about a place: its depth (negative outside) and the triangle next to it.
  struct Place {
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    double depth = -infinity;
    int triangle = -1;
  };
  struct Item {
    Into into;
    int ball = -1;  // a run of faces, or
    Triangle face;  // a face or a part of one, whose corners have been looked at
    Place middle;
  };
  struct Waiting {
    double bound;
    std::size_t item;
    int number;  // the earlier of two alike goes first
    bool operator<(const Waiting& other) const {
      return bound != other.bound ? bound < other.bound : number > other.number;
    }
  };

  double tolerance() const { return std::max(settings_.tolerance_mm, 1e-3 * depth_mm); }
  double enough() const { return depth_mm + tolerance(); }
  const Solid::ClosedShell& shell(Into into) const {
    return sides_[into.side].solid.shells_[into.shell];
  }

  Place look_at(Into into, const Eigen::Vector3d& p, const Place& near) {
    const TriangleTree& tree = shell(into).tree;
    double reach = infinity;  // a surface known to be near makes the query quick
    if (near.triangle >= 0)
      reach = (nearest_point(p, tree.corners(near.triangle)) - p).norm() + reach_rounding_mm;
    const SurfacePoint found = tree.signed_nearest(p, reach);
    ++looks_;
    return {p, -found.distance, found.triangle};
  }

  /// The same for a point of the surface: keeps the deepest.
  Place look_at_point(Into into, const Eigen::Vector3d& p, const Place& near) {
    const Place place = look_at(into, p, near);
    if (place.depth > depth_mm) {
      depth_mm = place.depth;
      side = into.side;
      point = p;
      outward = shell(into).tree.pseudonormal(shell(into).tree.signed_nearest(p, place.depth));
    }
    return place;
  }

  /// No point of t is deeper. None is deeper than near.depth and its way from there; nor deeper
  /// than it is far from any one triangle of the shell: that is greatest at a corner of t, and its
  /// excess goes with the square of t's size.
  double bound(Into into, const Triangle& t, const Place& near) const {
    double way2 = 0;
    for (const auto& corner : t) way2 = std::max(way2, (corner - near.at).squaredNorm());
    const double by_way = near.depth + std::sqrt(way2);
    if (by_way <= enough() || near.triangle < 0) return by_way;
    const Triangle& opposite = shell(into).tree.corners(near.triangle);
    double farthest2 = 0;
    for (const auto& corner : t)
      farthest2 = std::max(farthest2, (nearest_point(corner, opposite) - corner).squaredNorm());
    return std::min(by_way, std::sqrt(farthest2));
  }

  /// A face with a point outside lies outside as a whole unless the shell crosses it.
  bool is_outside(Into into, const Triangle& t, const Place& middle) const {
    if (middle.depth >= -reach_rounding_mm) return false;
    const Eigen::Vector3d low = t[0].cwiseMin(t[1]).cwiseMin(t[2]).array() - reach_rounding_mm,
                          high = t[0].cwiseMax(t[1]).cwiseMax(t[2]).array() + reach_rounding_mm;
    return !shell(into).tree.any_near(low, high, [&](const Triangle& other) {
      const Eigen::Vector3d low_other = other[0].cwiseMin(other[1]).cwiseMin(other[2]),
                            high_other = other[0].cwiseMax(other[1]).cwiseMax(other[2]);
      return (low_other.array() <= high.array()).all() &&
             (high_other.array() >= low.array()).all() &&
             triangle_distance(t, other, touching_mm2).squared_mm2 < touching_mm2;
    });
  }

  void wait(double bound, const Item& item) {
    if (bound <= enough()) return;
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

  void offer_ball(Into into, int index, const Place& near) {
    const Side& from = sides_[into.side];
    const Solid::Ball& ball = from.surface.balls_[index];
    const Eigen::Vector3d middle = from.X * ball.center;
    if (near.triangle >= 0 && near.depth + (middle - near.at).norm() + ball.radius <= enough())
      return;
    if (!shell(into).box.contains(middle, ball.radius)) return;
    if (crossing_known_ && ball.connected && !from.crosses(ball.first, ball.count) &&
        look_at_point(into, from.X * from.surface.faces_[ball.first][0], near).depth <
            -reach_rounding_mm)
      return;
    const Place place = look_at(into, middle, near);
    wait(place.depth + ball.radius, {into, index, {}, place});
  }

  void divide_ball(const Item& item) {
    const Side& from = sides_[item.into.side];
    const Solid::Ball& ball = from.surface.balls_[item.ball];
    if (ball.right != 0) {
      offer_ball(item.into, item.ball + 1, item.middle);
      offer_ball(item.into, ball.right, item.middle);
      return;
    }
    for (int i = ball.first; i < ball.first + ball.count; ++i)
      offer_face(item.into, i, item.middle);
  }

  Triangle face_of(const Side& from, int face) const {
    Triangle t = from.surface.faces_[face];
    for (auto& corner : t) corner = from.X * corner;
    return t;
  }

  /// Returns what was looked at last.
  Place offer_face(Into into, int index, const Place& near) {
    const Side& from = sides_[into.side];
    const Triangle face = face_of(from, index);
    if (near.triangle >= 0 && bound(into, face, near) <= enough()) return near;
    const Place middle = look_at_middle(into, face, near);
    if (bound(into, face, middle) <= enough()) return middle;
    if (crossing_known_ && !from.crosses(index, 1) ? middle.depth < -reach_rounding_mm
                                                   : is_outside(into, face, middle))
      return middle;
    for (const auto& corner : face) look_at_point(into, corner, middle);
    wait(bound(into, face, middle), {into, -1, face, middle});
    return middle;
  }

  /// Whether a piece of a surface lies wholly inside a shell that it does not cross.
  bool has_hidden_piece() const {
    for (const Side& from : sides_) {
      std::vector<bool> crosses(from.surface.piece_face_.size(), false);
      for (const int face : from.crossing) crosses[from.surface.piece_[face]] = true;
      for (std::size_t piece = 0; piece < crosses.size(); ++piece) {
        if (crosses[piece]) continue;
        const Eigen::Vector3d p = from.X * from.surface.faces_[from.surface.piece_face_[piece]][0];
        for (const auto& shell : from.solid.shells_)
          if (shell.depth(p, 0, infinity) > -reach_rounding_mm) return true;
      }
    }
    return false;
  }

  /// Offers what of a surface is inside a shell where none of its pieces is hidden: the faces that
  /// cross, and what hangs together with them on the inner side. False where that is much: then the
  /// balls know better.
  bool offer_inside(Into into) {
    const Side& from = sides_[into.side];
    std::vector<int> inside;
    std::set<int> seen;
    const auto spread = [&](int face, const Place& near) {
      from.surface.each_neighbour(face, [&](int other) {
        if (from.crosses(other, 1) || !seen.insert(other).second) return;
        if (look_at_point(into, face_of(from, other)[0], near).depth >= -reach_rounding_mm)
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
      if (inside.size() > most_inside) return false;
      near = offer_face(into, inside[i], near);
      spread(inside[i], near);
    }
    return true;
  }

  Place look_at_middle(Into into, const Triangle& t, const Place& near) {
    return look_at_point(into, (t[0] + t[1] + t[2]) / 3, near);
  }

  void divide_face(const Item& item) {
    const Triangle& t = item.face;
    std::size_t longest = 0;
    double length2 = -1;
    for (std::size_t k = 0; k < 3; ++k)
      if (const double l2 = (t[(k + 1) % 3] - t[k]).squaredNorm(); l2 > length2)
        length2 = l2, longest = k;
    const auto &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3];
    const Eigen::Vector3d half = (a + b) / 2;
    look_at_point(item.into, half, item.middle);
    for (const Triangle& part : {Triangle{a, half, c}, Triangle{half, b, c}}) {
      if (bound(item.into, part, item.middle) <= enough()) continue;
      const Place middle = look_at_middle(item.into, part, item.middle);
      const double most = bound(item.into, part, middle);
      if (most > enough() && !is_outside(item.into, part, middle))
        wait(most, {item.into, -1, part, middle});
    }
  }

  DepthSettings settings_;
  std::array<Side, 2> sides_;
  bool crossing_known_;
  std::vector<Item> items_;
  std::vector<std::size_t> free_;  // places in items_ to use again
  std::priority_queue<Waiting> waiting_;
  int looks_ = 0, number_ = 0;
};

OverlapDepth overlap_depth(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                           const DepthSettings& settings, const CrossingFaces* crossing) {
  const DepthSearch found(a, b, X_WA.inverse() * X_WB, settings, crossing);
  OverlapDepth overlap;
  overlap.error_mm = found.error_mm();
  if (found.depth_mm == 0) return overlap;
  const Pose& X = found.side == 0 ? X_WA : X_WB;
  overlap.depth_mm = found.depth_mm;
  overlap.point = X * found.point;
  overlap.normal = found.side == 0 ? X.R * found.outward : X.R * -found.outward;
  return overlap;
}

}  // namespace condyle
