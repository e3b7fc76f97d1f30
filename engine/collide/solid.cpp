#include "engine/collide/solid.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "engine/mesh/topology.h"

namespace condyle {
namespace {

constexpr int leaf_size = 4;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Every edge is run along as often one way as the other.
std::vector<bool> find_closed(const TriMesh& mesh, const Components& components) {
  std::vector<bool> closed(components.count, true);
  const EdgeList list = find_edges(mesh);
  for (const Edge& edge : list.edges) {
    int balance = 0;
    for (int i = 0; i < edge.count; ++i) balance += list.sides[edge.first + i].forward ? 1 : -1;
    if (balance != 0) closed[components.of_triangle[list.sides[edge.first].triangle]] = false;
  }
  return closed;
}

double distance_to(const Box& box, const Eigen::Vector3d& p) {
  return (p - p.cwiseMax(box.low).cwiseMin(box.high)).norm();
}

}  // namespace

Solid::Solid(const TriMesh& mesh) {
  assert(!mesh.empty());
  const Components components = find_components(mesh);
  shell_count_ = components.count;
  const std::vector<bool> closed = find_closed(mesh, components);

  std::vector<TriMesh> pieces(components.count);
  std::vector<bool> used(mesh.vertices.size(), false);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    pieces[components.of_triangle[i]].triangles.push_back(mesh.triangles[i]);
    for (int k = 0; k < 3; ++k) used[mesh.triangles[i][k]] = true;
  }
  std::vector<int> renumbered(mesh.vertices.size());
  std::vector<std::size_t> inward;
  for (std::size_t c = 0; c < pieces.size(); ++c) {
    TriMesh& piece = pieces[c];
    for (const auto& t : piece.triangles)
      for (int k = 0; k < 3; ++k) renumbered[t[k]] = -1;
    for (auto& t : piece.triangles)
      for (int k = 0; k < 3; ++k) {
        int& index = renumbered[t[k]];
        if (index < 0) {
          index = static_cast<int>(piece.vertices.size());
          piece.vertices.push_back(mesh.vertices[t[k]]);
        }
        t[k] = index;
      }
    samples_.push_back(piece.vertices.front());
    if (!closed[c])
      ++open_shell_count_;
    else if (signed_volume(piece) > 0)
      shells_.push_back({TriangleTree(piece), bounding_box(piece)});
    else
      inward.push_back(c);
  }
  const std::size_t outward_count = shells_.size();
  for (const std::size_t c : inward) {
    const auto holds = [&](const Shell& shell) {
      return depth_in(shell, samples_[c], 0, infinity) > 0;
    };
    if (std::any_of(shells_.begin(), shells_.begin() + static_cast<std::ptrdiff_t>(outward_count),
                    holds))
      continue;  // a cavity
    for (auto& t : pieces[c].triangles) std::swap(t[1], t[2]);
    shells_.push_back({TriangleTree(pieces[c]), bounding_box(pieces[c])});
  }

  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (used[v]) points_.push_back(mesh.vertices[v]);
  balls_.reserve(points_.size());
  build_balls(points_, 0, static_cast<int>(points_.size()));
}

int Solid::build_balls(std::vector<Eigen::Vector3d>& points, int first, int last) {
  Box box;
  for (int i = first; i < last; ++i) box.add(points[i]);
  const int index = static_cast<int>(balls_.size());
  balls_.push_back({box.center(), 0, first, last - first, 0});
  double radius2 = 0;
  for (int i = first; i < last; ++i)
    radius2 = std::max(radius2, (points[i] - balls_[index].center).squaredNorm());
  balls_[index].radius = std::sqrt(radius2);
  if (last - first <= leaf_size) return index;
  Eigen::Index axis = 0;
  box.size().maxCoeff(&axis);
  const int middle = first + (last - first) / 2;
  const auto before = [axis](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    for (Eigen::Index k = 0; k < 3; ++k) {  // a full order: the same tree on any machine
      const Eigen::Index i = (axis + k) % 3;
      if (p[i] != q[i]) return p[i] < q[i];
    }
    return false;
  };
  std::nth_element(points.begin() + first, points.begin() + middle, points.begin() + last, before);
  build_balls(points, first, middle);
  balls_[index].right = build_balls(points, middle, last);
  return index;
}

/// Depth of p inside the shell, negative outside; -infinity when a ball of `radius` about p cannot
/// reach it. `reach`: no less than the distance of p from the shell's surface, if known.
double Solid::depth_in(const Shell& shell, const Eigen::Vector3d& p, double radius, double reach) {
  if (distance_to(shell.box, p) > radius) return -infinity;
  return -shell.tree.signed_nearest(p, reach).distance;
}

double Solid::signed_distance(const Eigen::Vector3d& p) const {
  // The shell whose box is nearest goes first: its answer spares most others.
  std::size_t first = 0;
  double nearest_box = infinity;
  for (std::size_t i = 0; i < shells_.size(); ++i)
    if (const double d = distance_to(shells_[i].box, p); d < nearest_box) {
      nearest_box = d;
      first = i;
    }
  double least = infinity;
  for (std::size_t k = 0; k < shells_.size(); ++k) {
    const Shell& shell = shells_[k == 0 ? first : k <= first ? k - 1 : k];
    const double to_box = distance_to(shell.box, p);
    if (to_box > 0 && to_box >= least) continue;
    // Within its box the point may be deep inside, whatever the distance to the others.
    least = std::min(least, shell.tree.signed_nearest(p, to_box > 0 ? least : infinity).distance);
  }
  return least;
}

/// `center_depth` is the depth of the ball's centre. Depth changes by at most a millimetre per
/// millimetre: no vertex of the ball is deeper than center_depth + radius, and the distance of a
/// point near the centre is known well enough to keep its query short.
void Solid::search(const Shell& shell, const Pose& X, int ball_index, double center_depth,
                   Deepest& best) const {
  constexpr double rounding_mm = 1e-9;
  const Ball& ball = balls_[ball_index];
  if (center_depth + ball.radius <= best.depth_mm) return;
  if (ball.right == 0) {
    for (int i = ball.first; i < ball.first + ball.count; ++i) {
      const double step = (points_[i] - ball.center).norm();
      if (center_depth + step <= best.depth_mm) continue;
      const Eigen::Vector3d p = X * points_[i];
      if (!shell.box.contains(p)) continue;
      const SurfacePoint found =
          shell.tree.signed_nearest(p, std::abs(center_depth) + step + rounding_mm);
      if (-found.distance > best.depth_mm)
        best = {-found.distance, p, shell.tree.pseudonormal(found)};
    }
    return;
  }
  const int child[2] = {ball_index + 1, ball.right};
  double depth[2], bound[2];
  for (int k = 0; k < 2; ++k) {
    const Ball& part = balls_[child[k]];
    const double step = (part.center - ball.center).norm();
    depth[k] = -infinity;
    if (center_depth + step + part.radius > best.depth_mm)
      depth[k] = depth_in(shell, X * part.center, part.radius,
                          std::abs(center_depth) + step + rounding_mm);
    bound[k] = depth[k] + part.radius;
  }
  const int nearer = bound[1] > bound[0] ? 1 : 0;
  search(shell, X, child[nearer], depth[nearer], best);
  search(shell, X, child[1 - nearer], depth[1 - nearer], best);
}

/// The deepest vertex inside `other`, if deeper than `best` so far.
void Solid::deepest_inside(const Solid& other, const Pose& X_OS, Deepest& best) const {
  const Ball& all = balls_.front();
  for (const Shell& shell : other.shells_)
    search(shell, X_OS, 0, depth_in(shell, X_OS * all.center, all.radius, infinity), best);
}

bool Solid::has_shell_inside(const Solid& other, const Pose& X_OS) const {
  for (const auto& sample : samples_)
    for (const auto& shell : other.shells_)
      if (depth_in(shell, X_OS * sample, 0, infinity) > 0) return true;
  return false;
}

OverlapDepth overlap_depth(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB) {
  const Pose X_AB = X_WA.inverse() * X_WB;
  Solid::Deepest best;
  OverlapDepth overlap;
  b.deepest_inside(a, X_AB, best);
  if (best.depth_mm > 0) overlap = {best.depth_mm, X_WA * best.vertex, X_WA.R * best.outward};
  const double depth_of_b = best.depth_mm;
  a.deepest_inside(b, X_AB.inverse(), best);
  if (best.depth_mm > depth_of_b)
    overlap = {best.depth_mm, X_WB * best.vertex, -(X_WB.R * best.outward)};
  return overlap;
}

bool one_encloses_other(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB) {
  const Pose X_AB = X_WA.inverse() * X_WB;
  return b.has_shell_inside(a, X_AB) || a.has_shell_inside(b, X_AB.inverse());
}

}  // namespace condyle
