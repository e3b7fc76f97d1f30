#include "engine/mesh/triangle_tree.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "engine/core/hash.h"
#include "engine/core/infinity.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int leaf_size = 4;
constexpr int stack_size = 128;  // median splits: the depth is log2 of the count

double square_distance(const Vector3d& low, const Vector3d& high, const Vector3d& p) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

/// Barycentric coordinates of the point of the triangle nearest to p. Coordinates are exactly 0 on
/// edges and corners. source: Ericson, Real-Time Collision Detection, 5.1.5.
Vector3d nearest_barycentric(const std::array<Vector3d, 3>& t, const Vector3d& p) {
  const Vector3d ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vector3d bp = p - t[1];
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }
  const Vector3d cp = p - t[2];
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  if (!(sum > 0)) return {1, 0, 0};
  const double v = vb / sum, w = vc / sum;
  return {1 - v - w, v, w};
}

Vector3d at(const std::array<Vector3d, 3>& t, const Vector3d& b) {
  return b[0] * t[0] + b[1] * t[1] + b[2] * t[2];
}

/// Solid angle of a triangle seen from p. source: van Oosterom and Strackee 1983.
double solid_angle(const std::array<Vector3d, 3>& t, const Vector3d& p) {
  const Vector3d a = t[0] - p, b = t[1] - p, c = t[2] - p;
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  const double y = a.dot(b.cross(c));
  const double x = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
  return (x == 0 && y == 0) ? 0 : 2 * std::atan2(y, x);
}

double corner_angle(const Vector3d& at, const Vector3d& b, const Vector3d& c) {
  return std::atan2((b - at).cross(c - at).norm(), (b - at).dot(c - at));
}

/// For each vertex the first one at the same position.
std::vector<int> ids_of_positions(const std::vector<Vector3d>& vertices) {
  std::size_t slots = 16;
  while (slots < 2 * vertices.size()) slots *= 2;
  std::vector<int> first(slots, -1), id(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Vector3d p = vertices[v].array() + 0.0;  // -0 is 0
    std::size_t slot = hash_bytes(p.data(), 3 * sizeof(double)) & (slots - 1);
    while (first[slot] >= 0 && vertices[static_cast<std::size_t>(first[slot])] != p)
      slot = (slot + 1) & (slots - 1);
    if (first[slot] < 0) first[slot] = static_cast<int>(v);
    id[v] = first[slot];
  }
  return id;
}

/// A triangle's side between the vertices `low` and `high`.
struct Side {
  int low, high, slot, edge;
};

/// Stable. `count`: of the vertices.
void sort_by_low_and_high(std::vector<Side>& sides, std::size_t count) {
  std::vector<int> end(count + 1, 0);
  for (const Side& side : sides) ++end[static_cast<std::size_t>(side.low) + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<Side> sorted(sides.size());
  std::vector<int> next(end.begin(), end.end() - 1);
  for (const Side& side : sides) sorted[next[side.low]++] = side;
  constexpr std::ptrdiff_t few = 32;
  const auto less = [](const Side& x, const Side& y) { return x.high < y.high; };
  for (std::size_t v = 0; v < count; ++v) {
    const auto from = sorted.begin() + end[v], to = sorted.begin() + end[v + 1];
    if (to - from > few) {
      std::stable_sort(from, to, less);
      continue;
    }
    for (auto i = from; i != to; ++i) std::rotate(std::upper_bound(from, i, *i, less), i, i + 1);
  }
  sides = std::move(sorted);
}

/// Entry of the ray into the box, infinity when it misses or the box lies beyond `limit`.
double entry(const Vector3d& low, const Vector3d& high, const Vector3d& origin,
             const Vector3d& inverse, double limit) {
  double from = 0, to = limit;
  for (int k = 0; k < 3; ++k) {
    double a = (low[k] - origin[k]) * inverse[k], b = (high[k] - origin[k]) * inverse[k];
    // A ray in the plane of a slab yields 0 * infinity: such a slab does not limit it.
    if (std::isnan(a) || std::isnan(b)) continue;
    if (a > b) std::swap(a, b);
    from = std::max(from, a);
    to = std::min(to, b);
  }
  // Rounding of the slabs must not lose a triangle that lies in the box's wall.
  return from <= to * (1 + 1e-12) ? from : infinity;
}

}  // namespace

TriangleTree::TriangleTree(const TriMesh& mesh) {
  std::vector<int> order;
  std::vector<Vector3d> centers(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    assert(t.minCoeff() >= 0 && t.maxCoeff() < static_cast<int>(mesh.vertices.size()));
    const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    centers[i] = (a + b + c) / 3;
    assert(centers[i].allFinite());
    if ((b - a).cross(c - a).squaredNorm() > 0) order.push_back(static_cast<int>(i));
  }
  if (order.empty()) return;
  build(order, centers, 0, static_cast<int>(order.size()), mesh);

  triangle_ = order;
  slot_.assign(mesh.triangles.size(), -1);
  for (std::size_t s = 0; s < order.size(); ++s) {
    const auto& t = mesh.triangles[order[s]];
    corners_.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
    slot_[order[s]] = static_cast<int>(s);
  }
  make_face_normals();
  make_pseudonormals(mesh);
  make_clusters();
}

TriangleTree TriangleTree::moved(const TriMesh& mesh) const {
  assert(mesh.triangles.size() == slot_.size());
  TriangleTree tree;
  tree.nodes_ = nodes_;
  tree.triangle_ = triangle_;
  tree.slot_ = slot_;
  tree.corners_.reserve(corners_.size());
  for (const int triangle : triangle_) {
    const auto& t = mesh.triangles[triangle];
    tree.corners_.push_back({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]});
  }
  for (std::size_t i = tree.nodes_.size(); i-- > 0;) {
    Node& node = tree.nodes_[i];
    if (node.count == 0) {
      const Node &left = tree.nodes_[i + 1], &right = tree.nodes_[node.first];
      node.low = left.low.cwiseMin(right.low);
      node.high = left.high.cwiseMax(right.high);
      continue;
    }
    node.low.setConstant(infinity);
    node.high.setConstant(-infinity);
    for (int s = node.first; s < node.first + node.count; ++s)
      for (const Vector3d& corner : tree.corners_[s]) {
        node.low = node.low.cwiseMin(corner);
        node.high = node.high.cwiseMax(corner);
      }
  }
  tree.make_face_normals();
  return tree;
}

void TriangleTree::make_face_normals() {
  face_normals_.reserve(corners_.size());
  for (const auto& c : corners_)
    face_normals_.push_back((c[1] - c[0]).cross(c[2] - c[0]).normalized());
}

int TriangleTree::build(std::vector<int>& order, const std::vector<Vector3d>& centers, int first,
                        int last, const TriMesh& mesh) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.push_back(
      {Vector3d::Constant(infinity), Vector3d::Constant(-infinity), first, last - first});
  if (last - first <= leaf_size) {
    Node& leaf = nodes_.back();
    for (int i = first; i < last; ++i)
      for (int k = 0; k < 3; ++k) {
        const Vector3d& v = mesh.vertices[mesh.triangles[order[i]][k]];
        leaf.low = leaf.low.cwiseMin(v);
        leaf.high = leaf.high.cwiseMax(v);
      }
    return index;
  }

  Vector3d low = Vector3d::Constant(infinity), high = -low;
  for (int i = first; i < last; ++i) {
    low = low.cwiseMin(centers[order[i]]);
    high = high.cwiseMax(centers[order[i]]);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const int middle = first + (last - first) / 2;
  std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last,
                   [&](int a, int b) {
                     const double x = centers[a][axis], y = centers[b][axis];
                     return x < y || (x == y && a < b);
                   });
  const int left = build(order, centers, first, middle, mesh);
  const int right = build(order, centers, middle, last, mesh);
  Node& node = nodes_[index];
  node.low = nodes_[left].low.cwiseMin(nodes_[right].low);
  node.high = nodes_[left].high.cwiseMax(nodes_[right].high);
  node.first = right;
  node.count = 0;
  return index;
}

void TriangleTree::make_pseudonormals(const TriMesh& mesh) {
  // One id per position: the neighbours of an edge are found even where the file repeats vertices.
  const std::vector<int> id = ids_of_positions(mesh.vertices);

  std::vector<Vector3d> vertex_normal(mesh.vertices.size(), Vector3d::Zero());
  std::vector<Side> sides;
  sides.reserve(3 * corners_.size());
  // In the mesh's own order, so that the sums do not depend on how the tree was split.
  for (std::size_t t = 0; t < slot_.size(); ++t) {
    if (slot_[t] < 0) continue;
    const auto& c = corners_[slot_[t]];
    for (int k = 0; k < 3; ++k) {
      const int a = id[mesh.triangles[t][k]], b = id[mesh.triangles[t][(k + 1) % 3]];
      vertex_normal[a] +=
          corner_angle(c[k], c[(k + 1) % 3], c[(k + 2) % 3]) * face_normals_[slot_[t]];
      sides.push_back({std::min(a, b), std::max(a, b), slot_[t], k});
    }
  }
  sort_by_low_and_high(sides, mesh.vertices.size());
  edge_normals_.resize(corners_.size());
  corner_normals_.resize(corners_.size());
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i;
    Vector3d sum = Vector3d::Zero();
    for (; end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high;
         ++end)
      sum += face_normals_[sides[end].slot];
    for (; i < end; ++i) edge_normals_[sides[i].slot][sides[i].edge] = sum;
  }
  for (std::size_t s = 0; s < corners_.size(); ++s)
    for (int k = 0; k < 3; ++k)
      corner_normals_[s][k] = vertex_normal[id[mesh.triangles[triangle_[s]][k]]];
}

void TriangleTree::make_clusters() {
  clusters_.resize(nodes_.size());
  std::vector<double> area(nodes_.size(), 0.0);
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    const Node& node = nodes_[i];
    Cluster& cluster = clusters_[i];
    cluster.area_normal.setZero();
    Vector3d weighted = Vector3d::Zero();
    if (node.count > 0) {
      for (int s = node.first; s < node.first + node.count; ++s) {
        const auto& c = corners_[s];
        const Vector3d n = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]);
        cluster.area_normal += n;
        weighted += n.norm() * (c[0] + c[1] + c[2]) / 3;
        area[i] += n.norm();
      }
    } else {
      for (const std::size_t child : {i + 1, static_cast<std::size_t>(node.first)}) {
        cluster.area_normal += clusters_[child].area_normal;
        weighted += area[child] * clusters_[child].center;
        area[i] += area[child];
      }
    }
    cluster.center = weighted / area[i];
    cluster.radius = (cluster.center - node.low).cwiseMax(node.high - cluster.center).norm();
  }
}

SurfacePoint TriangleTree::nearest(const Vector3d& p, double reach) const {
  SurfacePoint best;
  if (empty() || !(reach >= 0)) return best;
  double limit = reach * reach;
  struct Waiting {
    int node;
    double square;
  };
  std::array<Waiting, stack_size> stack;
  int size = 0;
  const double root = square_distance(nodes_[0].low, nodes_[0].high, p);
  if (root <= limit) stack[size++] = {0, root};
  int best_slot = -1;
  while (size > 0) {
    const auto [index, square] = stack[--size];
    if (square > limit || (square == limit && best_slot >= 0)) continue;
    const Node& node = nodes_[index];
    if (node.count > 0) {
      for (int s = node.first; s < node.first + node.count; ++s) {
        const double height = face_normals_[s].dot(p - corners_[s][0]);
        if (height * height > limit * (1 + 1e-9) + 1e-24) continue;  // even its plane is too far
        const Vector3d b = nearest_barycentric(corners_[s], p);
        const Vector3d q = at(corners_[s], b);
        const double d = (q - p).squaredNorm();
        if (d < limit || (d == limit && best_slot < 0)) {
          limit = d;
          best_slot = s;
          best.point = q;
          best.barycentric = b;
        }
      }
      continue;
    }
    const int left = index + 1, right = node.first;
    const double dl = square_distance(nodes_[left].low, nodes_[left].high, p);
    const double dr = square_distance(nodes_[right].low, nodes_[right].high, p);
    if (dl <= dr) {
      if (dr <= limit) stack[size++] = {right, dr};
      if (dl <= limit) stack[size++] = {left, dl};
    } else {
      if (dl <= limit) stack[size++] = {left, dl};
      if (dr <= limit) stack[size++] = {right, dr};
    }
  }
  if (best_slot < 0) return best;
  best.triangle = triangle_[best_slot];
  best.distance = std::sqrt(limit);
  return best;
}

SurfacePoint TriangleTree::signed_nearest(const Vector3d& p, double reach) const {
  SurfacePoint found = nearest(p, reach);
  if (found.triangle >= 0 && (p - found.point).dot(pseudonormal(found)) < 0)
    found.distance = -found.distance;
  return found;
}

Vector3d TriangleTree::pseudonormal(const SurfacePoint& found) const {
  assert(!corner_normals_.empty() && found.triangle >= 0);
  const int s = slot_[found.triangle];
  const Vector3d& b = found.barycentric;
  const int zeros = (b[0] == 0) + (b[1] == 0) + (b[2] == 0);
  Vector3d normal = face_normals_[s];
  for (int k = 0; k < 3; ++k) {
    if (zeros == 2 && b[k] != 0) normal = corner_normals_[s][k];
    if (zeros == 1 && b[k] == 0) normal = edge_normals_[s][(k + 1) % 3];
  }
  const double length = normal.norm();
  return length > 0 ? Vector3d(normal / length) : face_normals_[s];
}

std::optional<SurfacePoint> TriangleTree::ray_cast(const Vector3d& origin,
                                                   const Vector3d& direction, double max_t) const {
  if (empty()) return std::nullopt;
  const Vector3d inverse = direction.cwiseInverse();
  SurfacePoint best;
  double limit = max_t;
  std::array<std::pair<int, double>, stack_size> stack;
  int size = 0;
  const double root = entry(nodes_[0].low, nodes_[0].high, origin, inverse, limit);
  if (root < infinity) stack[size++] = {0, root};
  while (size > 0) {
    const auto [index, from] = stack[--size];
    if (from > limit) continue;
    const Node& node = nodes_[index];
    if (node.count > 0) {
      // Edges are tested by signed volumes of the edge and the ray: the two triangles of an edge
      // see the same value with opposite sign, so that no ray slips between them.
      for (int s = node.first; s < node.first + node.count; ++s) {
        const Vector3d a = corners_[s][0] - origin, b = corners_[s][1] - origin,
                       c = corners_[s][2] - origin;
        const double u = direction.dot(c.cross(b)), v = direction.dot(a.cross(c)),
                     w = direction.dot(b.cross(a));
        if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) continue;
        const double sum = u + v + w;
        if (sum == 0) continue;
        const Vector3d n = (corners_[s][1] - corners_[s][0]).cross(corners_[s][2] - corners_[s][0]);
        const double t = n.dot(a) / n.dot(direction);
        if (!(t >= 0) || t > limit || (t == limit && best.triangle >= 0)) continue;
        limit = t;
        best.triangle = triangle_[s];
        best.barycentric = Vector3d(u, v, w) / sum;
        best.point = at(corners_[s], best.barycentric);
      }
      continue;
    }
    const int left = index + 1, right = node.first;
    const double el = entry(nodes_[left].low, nodes_[left].high, origin, inverse, limit);
    const double er = entry(nodes_[right].low, nodes_[right].high, origin, inverse, limit);
    if (el <= er) {
      if (er < infinity) stack[size++] = {right, er};
      if (el < infinity) stack[size++] = {left, el};
    } else {
      if (el < infinity) stack[size++] = {left, el};
      if (er < infinity) stack[size++] = {right, er};
    }
  }
  if (best.triangle < 0) return std::nullopt;
  best.distance = limit;
  return best;
}

double TriangleTree::winding_number(const Vector3d& p) const {
  if (empty()) return 0;
  constexpr double far = 3;  // in radii of the cluster
  double sum = 0;
  std::array<int, stack_size> stack;
  int size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const int index = stack[--size];
    const Cluster& cluster = clusters_[index];
    const Vector3d away = cluster.center - p;
    const double distance = away.norm();
    if (distance > far * cluster.radius) {
      sum += cluster.area_normal.dot(away) / (distance * distance * distance);
    } else if (const Node& node = nodes_[index]; node.count > 0) {
      for (int s = node.first; s < node.first + node.count; ++s) sum += solid_angle(corners_[s], p);
    } else {
      stack[size++] = node.first;
      stack[size++] = index + 1;
    }
  }
  return sum / (4 * std::numbers::pi);
}

std::size_t TriangleTree::bytes() const {
  const auto held = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  return held(nodes_) + held(clusters_) + held(corners_) + held(triangle_) + held(slot_) +
         held(edge_normals_) + held(corner_normals_) + held(face_normals_);
}

}  // namespace condyle
