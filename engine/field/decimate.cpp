#include "engine/field/decimate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <queue>
#include <vector>

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Sum of weighted squared distances to planes: p^T A p - 2 b^T p + c.
struct Quadric {
  Matrix3d A = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  double c = 0;

  void add_plane(const Vector3d& n, const Vector3d& on, double weight) {
    const double d = n.dot(on);
    A += weight * n * n.transpose();
    b += weight * d * n;
    c += weight * d * d;
  }
  Quadric& operator+=(const Quadric& other) {
    A += other.A;
    b += other.b;
    c += other.c;
    return *this;
  }
  double operator()(const Vector3d& p) const { return p.dot(A * p) - 2 * b.dot(p) + c; }
};

struct Candidate {
  double cost;
  int a, b;
  unsigned stamp;                                 // of both ends when it was created
  bool operator<(const Candidate& other) const {  // the priority queue returns the largest first
    if (cost != other.cost) return cost > other.cost;
    return std::pair(a, b) > std::pair(other.a, other.b);
  }
};

class Decimator {
 public:
  Decimator(const TriMesh& mesh, const DecimationOptions& options)
      : options_(options),
        position_(mesh.vertices),
        triangle_(mesh.triangles),
        around_(mesh.vertices.size()),
        quadric_(mesh.vertices.size()),
        stamp_(mesh.vertices.size(), 0),
        border_(mesh.vertices.size(), false),
        alive_(mesh.triangles.size(), true),
        live_(static_cast<int>(mesh.triangles.size())) {
    for (std::size_t t = 0; t < triangle_.size(); ++t)
      for (int i = 0; i < 3; ++i) around(triangle_[t][i]).push_back(static_cast<int>(t));
    make_quadrics();
  }

  TriMesh run() {
    std::vector<int> ring;
    for (int v = 0; v < static_cast<int>(position_.size()); ++v) {
      neighbours(v, ring);
      for (const int w : ring)
        if (v < w) push(v, w);
    }
    while (live_ > options_.target_triangles && !queue_.empty()) {
      const Candidate next = queue_.top();
      queue_.pop();
      if (next.stamp != stamp(next.a) + stamp(next.b) || around(next.a).empty() ||
          around(next.b).empty())
        continue;
      try_collapse(next.a, next.b);
    }
    return compact();
  }

 private:
  std::vector<int>& around(int v) { return around_[static_cast<std::size_t>(v)]; }
  Vector3d& position(int v) { return position_[static_cast<std::size_t>(v)]; }
  Quadric& quadric(int v) { return quadric_[static_cast<std::size_t>(v)]; }
  unsigned& stamp(int v) { return stamp_[static_cast<std::size_t>(v)]; }
  bool border(int v) const { return border_[static_cast<std::size_t>(v)]; }
  const Eigen::Vector3i& triangle(int t) const { return triangle_[static_cast<std::size_t>(t)]; }

  /// Sorted vertices that share an edge with v.
  void neighbours(int v, std::vector<int>& ring) {
    ring.clear();
    for (const int t : around(v))
      for (int i = 0; i < 3; ++i)
        if (triangle(t)[i] != v) ring.push_back(triangle(t)[i]);
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  }

  int triangles_at_edge(int a, int b) {
    int count = 0;
    for (const int t : around(a)) {
      const auto& corner = triangle(t);
      count += corner[0] == b || corner[1] == b || corner[2] == b;
    }
    return count;
  }

  void make_quadrics() {
    for (std::size_t t = 0; t < triangle_.size(); ++t) {
      const auto corner = triangle_[t];
      const Vector3d p = position(corner[0]);
      const Vector3d cross = (position(corner[1]) - p).cross(position(corner[2]) - p);
      const double length = cross.norm();
      if (length < 1e-14) continue;
      for (int i = 0; i < 3; ++i) quadric(corner[i]).add_plane(cross / length, p, length / 6);
    }
    for (std::size_t t = 0; t < triangle_.size(); ++t)  // open edges: a wall through each
      for (int i = 0; i < 3; ++i) {
        const int a = triangle_[t][i], b = triangle_[t][(i + 1) % 3], c = triangle_[t][(i + 2) % 3];
        if (triangles_at_edge(a, b) != 1) continue;
        border_[static_cast<std::size_t>(a)] = border_[static_cast<std::size_t>(b)] = true;
        const Vector3d edge = position(b) - position(a);
        const Vector3d n = edge.cross((position(c) - position(a)).cross(edge)).normalized();
        if (!n.allFinite()) continue;
        for (const int v : {a, b}) quadric(v).add_plane(n, position(a), edge.squaredNorm());
      }
  }

  /// The merged position of both ends, and its error.
  double best_position(int a, int b, Vector3d& p) {
    Quadric q = quadric(a);
    q += quadric(b);
    const Vector3d middle = 0.5 * (position(a) + position(b));
    if (border(a) != border(b)) {
      p = border(a) ? position(a) : position(b);
    } else {
      const double ease = 1e-3 * (q.A.trace() + 1e-12);
      const Matrix3d A = q.A + ease * Matrix3d::Identity();
      p = A.ldlt().solve(q.b + ease * middle);
      if (!p.allFinite() || (p - middle).squaredNorm() > (position(a) - position(b)).squaredNorm())
        p = middle;
      if (position(a).x() == 0 && position(b).x() == 0) p.x() = 0;
    }
    return std::max(q(p), 0.0);
  }

  void push(int a, int b) {
    Vector3d p;
    const double error = best_position(a, b, p);
    const double length2 = (position(a) - position(b)).squaredNorm();
    const double weight = options_.importance ? options_.importance(p) : 1;
    queue_.push(
        {weight * (error + options_.evenness * length2 * length2), a, b, stamp(a) + stamp(b)});
  }

  bool keeps_topology(int a, int b, const std::vector<int>& ring_a,
                      const std::vector<int>& ring_b) {
    const int faces = triangles_at_edge(a, b);
    if (border(a) && border(b) && faces != 1) return false;
    common_.clear();
    std::set_intersection(ring_a.begin(), ring_a.end(), ring_b.begin(), ring_b.end(),
                          std::back_inserter(common_));
    if (static_cast<int>(common_.size()) != faces) return false;
    if (ring_a.size() + ring_b.size() - common_.size() - 2 < 3) return false;
    if (border(a) == border(b)) return true;
    // The border end stays: no other neighbour of the removed one may lie on a border too.
    const auto& ring = border(a) ? ring_b : ring_a;
    const int stays = border(a) ? a : b;
    for (const int v : ring)
      if (v != stays && border(v) && !std::binary_search(common_.begin(), common_.end(), v))
        return false;
    return true;
  }

  /// No triangle around v (except those removed with `other`) may flip or become a needle.
  bool keeps_shape(int v, int other, const Vector3d& p) {
    for (const int t : around(v)) {
      const auto& corner = triangle(t);
      if (corner[0] == other || corner[1] == other || corner[2] == other) continue;
      const int i = corner[0] == v ? 0 : corner[1] == v ? 1 : 2;
      const Vector3d &b = position(corner[(i + 1) % 3]), &c = position(corner[(i + 2) % 3]);
      const Vector3d was = (b - position(v)).cross(c - position(v)), is = (b - p).cross(c - p);
      const double longest2 =
          std::max({(b - p).squaredNorm(), (c - p).squaredNorm(), (c - b).squaredNorm()});
      const double is_norm = is.norm(), was_norm = was.norm();
      if (is_norm < 0.04 * longest2) return false;
      if (is.dot(was) < 0.3 * is_norm * was_norm) return false;
    }
    return true;
  }

  void try_collapse(int a, int b) {
    neighbours(a, ring_a_);
    neighbours(b, ring_b_);
    if (!keeps_topology(a, b, ring_a_, ring_b_)) return;
    Vector3d p;
    best_position(a, b, p);
    if (!keeps_shape(a, b, p) || !keeps_shape(b, a, p)) return;

    if (border(b)) std::swap(a, b);
    for (const int t : around(b)) {
      auto& corner = triangle_[static_cast<std::size_t>(t)];
      if (corner[0] == a || corner[1] == a || corner[2] == a) {
        alive_[static_cast<std::size_t>(t)] = false;
        --live_;
        for (int i = 0; i < 3; ++i)
          if (corner[i] != b) std::erase(around(corner[i]), t);
        continue;
      }
      for (int i = 0; i < 3; ++i)
        if (corner[i] == b) corner[i] = a;
      around(a).push_back(t);
    }
    around(b).clear();
    position(a) = p;
    quadric(a) += quadric(b);
    ++stamp(a);
    neighbours(a, ring_a_);
    for (const int v : ring_a_) push(std::min(a, v), std::max(a, v));
  }

  TriMesh compact() const {
    TriMesh out;
    std::vector<int> number(position_.size(), -1);
    for (std::size_t t = 0; t < triangle_.size(); ++t) {
      if (!alive_[t]) continue;
      Eigen::Vector3i corner;
      for (int i = 0; i < 3; ++i) {
        int& id = number[static_cast<std::size_t>(triangle_[t][i])];
        if (id < 0) {
          id = static_cast<int>(out.vertices.size());
          out.vertices.push_back(position_[static_cast<std::size_t>(triangle_[t][i])]);
        }
        corner[i] = id;
      }
      out.triangles.push_back(corner);
    }
    return out;
  }

  const DecimationOptions& options_;
  std::vector<Vector3d> position_;
  std::vector<Eigen::Vector3i> triangle_;
  std::vector<std::vector<int>> around_;  // triangles at each vertex
  std::vector<Quadric> quadric_;
  std::vector<unsigned> stamp_;
  std::vector<bool> border_, alive_;
  int live_;
  std::priority_queue<Candidate> queue_;
  std::vector<int> ring_a_, ring_b_, common_;
};

}  // namespace

TriMesh decimated(const TriMesh& mesh, const DecimationOptions& options) {
  return Decimator(mesh, options).run();
}

}  // namespace condyle
