#include "engine/cut/fill_loops.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/cut/clip_ears.h"
#include "engine/cut/flip_edges.h"
#include "engine/cut/plane_geometry.h"

namespace condyle {
namespace {

using Points = std::span<const Eigen::Vector2d>;
using Loop = std::vector<int>;
constexpr double infinite = std::numeric_limits<double>::infinity();

double loop_area(Points p, const Loop& loop) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i)
    twice += double_area(p[loop[0]], p[loop[i]], p[loop[i + 1]]);
  return twice / 2;
}

bool is_inside(Points p, const Loop& loop, const Eigen::Vector2d& q) {
  bool inside = false;
  for (std::size_t i = 0, j = loop.size() - 1; i < loop.size(); j = i++) {
    const Eigen::Vector2d &a = p[loop[i]], &b = p[loop[j]];
    if ((a.y() > q.y()) != (b.y() > q.y()) &&
        q.x() < (b.x() - a.x()) * (q.y() - a.y()) / (b.y() - a.y()) + a.x())
      inside = !inside;
  }
  return inside;
}

std::size_t rightmost(Points p, const Loop& loop) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < loop.size(); ++i)
    if (p[loop[i]].x() > p[loop[best]].x()) best = i;
  return best;
}

/// Place in the ring of the nearest edge to the right of a point, and its distance along x; -1
/// without one.
std::pair<int, double> edge_to_the_right(Points p, const Loop& ring, const Eigen::Vector2d& from) {
  double nearest = infinite;
  int edge = -1;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d &a = p[ring[i]], &b = p[ring[(i + 1) % ring.size()]];
    const bool flat = a.y() == from.y() && b.y() == from.y();
    if (!flat && !(a.y() <= from.y() && b.y() > from.y())) continue;
    const double x = flat ? std::min(a.x(), b.x())
                          : a.x() + (from.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (x < from.x() - 1e-12 || x >= nearest) continue;
    nearest = x;
    edge = static_cast<int>(i);
  }
  return {edge, nearest};
}

/// Whether a bridge from ring place i to a point starts within the ring's corner there.
bool in_corner(Points p, const Loop& ring, std::size_t i, const Eigen::Vector2d& to) {
  const Eigen::Vector2d &before = p[ring[(i + ring.size() - 1) % ring.size()]], &at = p[ring[i]],
                        &after = p[ring[(i + 1) % ring.size()]];
  const bool left_of_first = double_area(before, at, to) > 0,
             left_of_second = double_area(at, after, to) > 0;
  return double_area(before, at, after) > 0 ? left_of_first && left_of_second
                                            : left_of_first || left_of_second;
}

/// Place in the ring that a point of a hole sees. none: -1.
int visible_place(Points p, const Loop& ring, const Eigen::Vector2d& from) {
  const auto [edge, x] = edge_to_the_right(p, ring, from);
  if (edge < 0) return -1;
  const int next = (edge + 1) % static_cast<int>(ring.size());
  int place = p[ring[edge]].x() > p[ring[next]].x() ? edge : next;
  // A corner of the ring within the triangle of point, hit and place hides the place: that with the
  // least slope is seen.
  const Eigen::Vector2d hit(x, from.y()), target = p[ring[place]];
  double least_slope = infinite;
  const int hidden = ring[place];
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (ring[i] == hidden) continue;
    const Eigen::Vector2d& q = p[ring[i]];
    if (q.x() < from.x()) continue;
    const double a = double_area(from, hit, q), b = double_area(hit, target, q),
                 c = double_area(target, from, q);
    if (!(a >= 0 && b >= 0 && c >= 0) && !(a <= 0 && b <= 0 && c <= 0)) continue;
    const double slope = std::abs(q.y() - from.y()) / (q.x() - from.x() + 1e-30);
    if (slope >= least_slope) continue;
    least_slope = slope;
    place = static_cast<int>(i);
  }
  // Bridges repeat corners; the bridge starts at the one whose corner holds it.
  for (std::size_t i = 0; i < ring.size(); ++i)
    if (ring[i] == ring[place] && in_corner(p, ring, i, from)) return static_cast<int>(i);
  return place;
}

/// Joins a hole to the ring around it by a bridge that is traversed both ways.
void join_hole(Points p, Loop& ring, const Loop& hole, int& forced) {
  const std::size_t start = rightmost(p, hole);
  int place = visible_place(p, ring, p[hole[start]]);
  if (place < 0) {
    ++forced;
    place = 0;
  }
  Loop joined(ring.begin(), ring.begin() + place + 1);
  for (std::size_t k = 0; k <= hole.size(); ++k) joined.push_back(hole[(start + k) % hole.size()]);
  joined.insert(joined.end(), ring.begin() + place, ring.end());
  ring = std::move(joined);
}

}  // namespace

LoopFill fill_loops(Points p, const std::vector<Loop>& loops) {
  struct Outline {
    Loop loop;
    double area;
    std::vector<Loop> holes;
  };
  LoopFill fill;
  std::vector<Outline> outlines;
  std::vector<Loop> holes;
  for (const Loop& loop : loops) {
    if (loop.size() < 3) continue;
    const double area = loop_area(p, loop);
    if (area >= 0)
      outlines.push_back({loop, area, {}});
    else
      holes.push_back(loop);
  }
  for (const Loop& hole : holes) {
    // The smallest outline that holds most of three points of it.
    Outline* around = nullptr;
    for (Outline& outline : outlines) {
      int inside = 0;
      for (std::size_t k = 0; k < 3; ++k)
        inside += is_inside(p, outline.loop, p[hole[k * hole.size() / 3]]);
      if (inside >= 2 && (!around || outline.area < around->area)) around = &outline;
    }
    if (around)
      around->holes.push_back(hole);
    else
      outlines.push_back({hole, 0, {}});
  }
  for (Outline& outline : outlines) {
    std::stable_sort(outline.holes.begin(), outline.holes.end(), [&](const Loop& a, const Loop& b) {
      return p[a[rightmost(p, a)]].x() > p[b[rightmost(p, b)]].x();
    });
    for (const Loop& hole : outline.holes) join_hole(p, outline.loop, hole, fill.forced);
    fill.forced += clip_ears(p, outline.loop, fill.triangles);
  }
  flip_edges(p, fill.triangles);
  for (const auto& t : fill.triangles) {
    const double longest =
        std::max({(p[t[0]] - p[t[1]]).squaredNorm(), (p[t[1]] - p[t[2]]).squaredNorm(),
                  (p[t[2]] - p[t[0]]).squaredNorm()});
    fill.turned += double_area(p[t[0]], p[t[1]], p[t[2]]) < -1e-8 * longest;
  }
  return fill;
}

}  // namespace condyle
