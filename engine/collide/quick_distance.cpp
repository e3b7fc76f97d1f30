#include "engine/collide/quick_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

#include "engine/mesh/measure.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Four numbers in one vector register; comparisons give selection masks.
using Four = float __attribute__((vector_size(16)));

struct Four3 {
  Four x, y, z;
};

Four four(float value) { return Four{value, value, value, value}; }

Four load(const std::array<float, 4>& lane) {
  Four value;
  std::memcpy(&value, lane.data(), sizeof value);
  return value;
}
Four3 load(const std::array<std::array<float, 4>, 3>& lanes) {
  return {load(lanes[0]), load(lanes[1]), load(lanes[2])};
}

Four dot(const Four3& a, const Four3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Four3 minus(const Four3& a, const Four3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

Four clamp01(Four v) {
  v = v > 0 ? v : four(0);
  return v < 1 ? v : four(1);
}

/// The nearest point on each of four triangles: a + v ab + w ac.
struct Nearest {
  Four v, w, square;
};

template <class Packet>
Nearest nearest_of(const Packet& t, const Four3& p) {
  const Four3 ab = load(t.ab), ac = load(t.ac), ap = minus(p, load(t.a));
  const Four d1 = dot(ab, ap), d2 = dot(ac, ap);
  const Four ab2 = load(t.ab2), ac2 = load(t.ac2), abac = load(t.abac);
  const Four zero = four(0), one = four(1);
  const Four square_a = dot(ap, ap);
  // |ap - v ab - w ac|^2; its minimum is the projection on the plane where that lies inside,
  // otherwise on one of the three edges.
  const auto square_at = [&](Four v, Four w) {
    const Four3 q = {ap.x - v * ab.x - w * ac.x, ap.y - v * ab.y - w * ac.y,
                     ap.z - v * ab.z - w * ac.z};
    return dot(q, q);
  };
  const Four per_area2 = load(t.per_area2);
  const Four fv = (ac2 * d1 - abac * d2) * per_area2, fw = (ab2 * d2 - abac * d1) * per_area2;
  const auto inside = (fv > 0) & (fw > 0) & (fv + fw < 1);
  const Four on_ab = clamp01(d1 * load(t.per_ab2)), on_ac = clamp01(d2 * load(t.per_ac2));
  const Four on_bc = clamp01((d2 - d1 + ab2 - abac) * load(t.per_bc2));
  // The edge is selected by squared distances from dot products, which are accurate enough for
  // that; the result is recomputed.
  const Four by_ab = square_a + on_ab * (on_ab * ab2 - 2 * d1);
  const Four by_ac = square_a + on_ac * (on_ac * ac2 - 2 * d2);
  const Four bv = one - on_bc;
  const Four by_bc =
      square_a + bv * (bv * ab2 + 2 * on_bc * abac - 2 * d1) + on_bc * (on_bc * ac2 - 2 * d2);
  Four v = on_ab, w = zero, least = by_ab;
  auto closer = by_ac < least;
  v = closer ? zero : v;
  w = closer ? on_ac : w;
  least = closer ? by_ac : least;
  closer = by_bc < least;
  v = closer ? bv : v;
  w = closer ? on_bc : w;
  v = inside ? fv : v;
  w = inside ? fw : w;
  return {v, w, square_at(v, w)};
}

bool any(decltype(Four{} < Four{}) mask) {
  std::array<std::int64_t, 2> halves;
  std::memcpy(halves.data(), &mask, sizeof mask);
  return (halves[0] | halves[1]) != 0;
}

Four outside(const std::array<float, 4>& low, const std::array<float, 4>& high, Four at) {
  const Four below = load(low) - at, above = at - load(high);
  const Four off = below > above ? below : above;
  return off > 0 ? off : four(0);
}

/// Index of the normal at that point: corners, edges, face.
std::size_t normal_at(float v, float w) {
  constexpr float hair = 1e-6f;  // tolerance of the classification as an edge
  const bool on_ac = v <= hair, on_ab = w <= hair, on_bc = v + w >= 1 - hair;
  if (on_ac && on_ab) return 0;
  if (on_ab && on_bc) return 1;
  if (on_ac && on_bc) return 2;
  return on_ab ? 3 : on_bc ? 4 : on_ac ? 5 : 6;
}

}  // namespace

/// Splits the triangles in halves twice: four children per node.
class QuickDistance::Builder {
 public:
  Builder(const TriMesh& mesh, QuickDistance& out) : mesh_(mesh), out_(out), tree_(mesh) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const auto& t = mesh.triangles[i];
      const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
      centers_.push_back(a + b + c);
      const Vector3f ab = (b - a).cast<float>(), ac = (c - a).cast<float>();
      const float area = ab.squaredNorm() * ac.squaredNorm() - ab.dot(ac) * ab.dot(ac);
      // Slivers that degenerate to lines in single precision have coincident neighbours.
      if (area > 1e-10f * ab.squaredNorm() * ac.squaredNorm())
        order_.push_back(static_cast<int>(i));
    }
    if (order_.empty())
      for (std::size_t i = 0; i < mesh.triangles.size(); ++i) order_.push_back(static_cast<int>(i));
    add(0, static_cast<int>(order_.size()));
  }

 private:
  int split(int first, int last) {
    Box box;
    for (int i = first; i < last; ++i) box.add(centers_[order_[i]]);
    Eigen::Index axis = 0;
    box.size().maxCoeff(&axis);
    const int middle = first + (last - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                     [&](int a, int b) {
                       const double x = centers_[a][axis], y = centers_[b][axis];
                       return x < y || (x == y && a < b);
                     });
    return middle;
  }

  int add(int first, int last) {
    const auto index = out_.nodes_.size();
    out_.nodes_.emplace_back();
    const int middle = split(first, last);
    const std::array<int, 5> ends = {first, split(first, middle), middle, split(middle, last),
                                     last};
    for (int k = 0; k < lanes; ++k) {
      const int from = ends[k], to = ends[k + 1];
      std::int32_t child = none;
      Box box;
      for (int i = from; i < to; ++i)
        for (const int v : mesh_.triangles[order_[i]]) box.add(mesh_.vertices[v] - out_.origin_);
      if (from < to) child = to - from > lanes ? add(from, to) : ~packet(from, to);
      Node& node = out_.nodes_[index];
      node.child[k] = child;
      for (int x = 0; x < 3; ++x) {
        node.low[x][k] = static_cast<float>(box.low[x]);
        node.high[x][k] = static_cast<float>(box.high[x]);
      }
    }
    return static_cast<int>(index);
  }

  int packet(int first, int last) {
    Packet packet;
    for (int k = 0; k < lanes; ++k) {
      const int i = order_[first + k < last ? first + k : first];
      const auto& t = mesh_.triangles[i];
      const Vector3d a = mesh_.vertices[t[0]] - out_.origin_,
                     b = mesh_.vertices[t[1]] - out_.origin_,
                     c = mesh_.vertices[t[2]] - out_.origin_;
      for (int x = 0; x < 3; ++x) {
        packet.a[x][k] = static_cast<float>(a[x]);
        packet.ab[x][k] = static_cast<float>(b[x] - a[x]);
        packet.ac[x][k] = static_cast<float>(c[x] - a[x]);
      }
      const Vector3d ab = b - a, ac = c - a;
      const double ab2 = ab.squaredNorm(), ac2 = ac.squaredNorm(), abac = ab.dot(ac);
      packet.ab2[k] = static_cast<float>(ab2);
      packet.ac2[k] = static_cast<float>(ac2);
      packet.abac[k] = static_cast<float>(abac);
      packet.per_ab2[k] = static_cast<float>(1 / ab2);
      packet.per_ac2[k] = static_cast<float>(1 / ac2);
      packet.per_bc2[k] = static_cast<float>(1 / (c - b).squaredNorm());
      packet.per_area2[k] = static_cast<float>(1 / ab.cross(ac).squaredNorm());
      constexpr std::array<std::array<double, 3>, 7> places = {
          {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {.5, .5, 0}, {0, .5, .5}, {.5, 0, .5}, {.4, .3, .3}}};
      Normals normals;
      for (std::size_t n = 0; n < places.size(); ++n) {
        SurfacePoint place;
        place.triangle = i;
        place.barycentric = {places[n][0], places[n][1], places[n][2]};
        normals[n] = tree_.pseudonormal(place).cast<float>();
      }
      out_.normals_.push_back(normals);
    }
    out_.packets_.push_back(packet);
    return static_cast<int>(out_.packets_.size()) - 1;
  }

  const TriMesh& mesh_;
  QuickDistance& out_;
  TriangleTree tree_;  // for its normals
  std::vector<Vector3d> centers_;
  std::vector<int> order_;
};

QuickDistance::QuickDistance(const TriMesh& mesh) : origin_(bounding_box(mesh).center()) {
  assert(!mesh.empty());
  Builder(mesh, *this);
}

float QuickDistance::signed_distance(const Vector3d& point, float limit, Start& start) const {
  const Vector3f p = (point - origin_).cast<float>();
  const Four3 at = {four(p.x()), four(p.y()), four(p.z())};
  float best = limit < 1e18f ? limit * limit : std::numeric_limits<float>::infinity();
  std::int32_t best_packet = -1;
  int best_lane = 0;
  float best_v = 0, best_w = 0;
  const auto look_at = [&](std::int32_t index) {
    const Packet& packet = packets_[index];
    const Nearest found = nearest_of(packet, at);
    if (!any(found.square < four(best))) return;
    for (int k = 0; k < lanes; ++k)
      if (found.square[k] < best) {
        best = found.square[k];
        best_packet = index;
        best_lane = k;
        best_v = found.v[k];
        best_w = found.w[k];
      }
  };
  if (start.packet >= 0) look_at(start.packet);
  struct Waiting {
    std::int32_t child;
    float square;
  };
  std::array<Waiting, 3 * 32 + 4> stack;  // 4^32 triangles
  int size = 0;
  stack[size++] = {0, 0};
  while (size > 0) {
    const auto [child, square] = stack[--size];
    if (square >= best) continue;
    if (child < 0) {
      look_at(~child);
      continue;
    }
    const Node& node = nodes_[child];
    const Four x = outside(node.low[0], node.high[0], at.x),
               y = outside(node.low[1], node.high[1], at.y),
               z = outside(node.low[2], node.high[2], at.z);
    const Four squares = x * x + y * y + z * z;
    if (!any(squares < four(best))) continue;
    // The nearest child is visited next.
    const int top = size;
    for (int k = 0; k < lanes; ++k) {
      if (node.child[k] == none || squares[k] >= best) continue;
      int place = size++;
      for (; place > top && stack[place - 1].square < squares[k]; --place)
        stack[place] = stack[place - 1];
      stack[place] = {node.child[k], squares[k]};
    }
  }
  if (best_packet < 0) return std::numeric_limits<float>::infinity();
  start.packet = best_packet;
  const Packet& packet = packets_[best_packet];
  const Vector3f normal = normals_[static_cast<std::size_t>(lanes * best_packet + best_lane)]
                                  [normal_at(best_v, best_w)];
  Vector3f away;
  for (int x = 0; x < 3; ++x)
    away[x] = p[x] - packet.a[x][best_lane] - best_v * packet.ab[x][best_lane] -
              best_w * packet.ac[x][best_lane];
  const float distance = std::sqrt(best);
  return away.dot(normal) < 0 ? -distance : distance;
}

}  // namespace condyle
