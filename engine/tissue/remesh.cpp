#include "engine/tissue/remesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

/// A triangle mesh with local edge operations. Deleted triangles have -1 as first corner.
class EdgeMesh {
 public:
  explicit EdgeMesh(const TriMesh& mesh)
      : position(mesh.vertices), triangles(mesh.triangles), around_(mesh.vertices.size()) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) around_[triangles[t][k]].push_back(static_cast<int>(t));
    border.resize(position.size(), 0);
    for (std::size_t v = 0; v < position.size(); ++v)
      for (int n : neighbours(static_cast<int>(v)))
        if (wings(static_cast<int>(v), n).size() == 1) border[v] = 1;
    pinned.resize(position.size(), 0);
  }

  std::vector<Vector3d> position;
  std::vector<Vector3i> triangles;
  std::vector<char> border, pinned;

  const std::vector<int>& around(int v) const { return around_[v]; }

  std::vector<int> neighbours(int v) const {
    std::vector<int> out;
    for (int t : around_[v])
      for (int k = 0; k < 3; ++k)
        if (triangles[t][k] != v) out.push_back(triangles[t][k]);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  /// Triangles at an edge.
  std::vector<int> wings(int a, int b) const {
    std::vector<int> out;
    for (int t : around_[a])
      if ((triangles[t].array() == b).any()) out.push_back(t);
    return out;
  }

  int third(int t, int a, int b) const {
    for (int k = 0; k < 3; ++k)
      if (triangles[t][k] != a && triangles[t][k] != b) return triangles[t][k];
    return -1;
  }

  Vector3d area_normal(const Vector3i& t) const {
    return 0.5 * (position[t[1]] - position[t[0]]).cross(position[t[2]] - position[t[0]]);
  }

  Vector3d normal(int v) const {
    Vector3d n = Vector3d::Zero();
    for (int t : around_[v]) n += area_normal(triangles[t]);
    return n.normalized();
  }

  void replace(int t, int from, int to) {
    for (int k = 0; k < 3; ++k)
      if (triangles[t][k] == from) triangles[t][k] = to;
    auto& list = around_[from];
    list.erase(std::find(list.begin(), list.end(), t));
    around_[to].push_back(t);
  }

  void remove(int t) {
    for (int k = 0; k < 3; ++k) {
      auto& list = around_[triangles[t][k]];
      list.erase(std::find(list.begin(), list.end(), t));
    }
    triangles[t][0] = -1;
  }

  void add(const Vector3i& t) {
    for (int k = 0; k < 3; ++k) around_[t[k]].push_back(static_cast<int>(triangles.size()));
    triangles.push_back(t);
  }

  int add_vertex(const Vector3d& p, bool at_border) {
    position.push_back(p);
    border.push_back(at_border);
    pinned.push_back(0);
    around_.emplace_back();
    return static_cast<int>(position.size()) - 1;
  }

  bool alive(int v) const { return !around_[v].empty(); }
  int vertices() const { return static_cast<int>(position.size()); }

  std::vector<std::array<int, 2>> edges() const {
    std::vector<std::array<int, 2>> out;
    for (const auto& t : triangles) {
      if (t[0] < 0) continue;
      for (int k = 0; k < 3; ++k)
        out.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

 private:
  std::vector<std::vector<int>> around_;
};

/// Whether the triangles around `v`, except `skip`, keep their orientation with v at p.
bool keeps_facing(const EdgeMesh& mesh, int v, const Vector3d& p, int skip_a, int skip_b) {
  for (int t : mesh.around(v)) {
    if (t == skip_a || t == skip_b) continue;
    const Vector3i& tri = mesh.triangles[t];
    std::array<Vector3d, 3> c;
    for (int k = 0; k < 3; ++k) c[k] = tri[k] == v ? p : mesh.position[tri[k]];
    const Vector3d before = mesh.area_normal(tri);
    const Vector3d after = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]);
    const double longest2 = std::max(
        {(c[1] - c[0]).squaredNorm(), (c[2] - c[1]).squaredNorm(), (c[0] - c[2]).squaredNorm()});
    if (after.norm() < 0.02 * longest2) return false;
    // Degenerate triangles are not restricted.
    if (before.norm() > 0 && after.dot(before) < 0.5 * after.norm() * before.norm()) return false;
  }
  return true;
}

/// Collapses `gone` into `kept`. False, without a change, where that would fold or pinch the mesh.
bool collapse(EdgeMesh& mesh, const RemeshSettings& settings, int gone, int kept) {
  if (mesh.pinned[gone]) return false;
  const auto wings = mesh.wings(gone, kept);
  if (wings.empty() || wings.size() > 2) return false;
  if (mesh.border[gone] && wings.size() != 1) return false;  // a border vertex stays on the border
  // Link condition: the two may share only the tips of their wings.
  const auto a = mesh.neighbours(gone), b = mesh.neighbours(kept);
  std::vector<int> shared;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(shared));
  if (shared.size() != wings.size()) return false;
  if (mesh.border[gone] && mesh.border[kept] && a.size() <= 2) return false;
  for (int tip : shared)
    if (mesh.neighbours(tip).size() <= (mesh.border[tip] ? 2u : 3u)) return false;
  for (int n : a) {  // no edge long enough to be split again
    const double length = (mesh.position[n] - mesh.position[kept]).norm();
    if (length > 1.4 * settings.edge_length(0.5 * (mesh.position[n] + mesh.position[kept])))
      return false;
  }
  const int w0 = wings[0], w1 = wings.size() > 1 ? wings[1] : -1;
  if (!keeps_facing(mesh, gone, mesh.position[kept], w0, w1)) return false;
  for (int t : wings) mesh.remove(t);
  const auto rest = mesh.around(gone);
  for (int t : rest) mesh.replace(t, gone, kept);
  return true;
}

void split_long(EdgeMesh& mesh, const RemeshSettings& settings) {
  for (const auto& [a, b] : mesh.edges()) {
    const Vector3d middle = 0.5 * (mesh.position[a] + mesh.position[b]);
    const double length = (mesh.position[a] - mesh.position[b]).norm();
    if (length <= 4.0 / 3.0 * settings.edge_length(middle)) continue;
    const auto wings = mesh.wings(a, b);
    if (wings.empty()) continue;
    const int m = mesh.add_vertex(middle, wings.size() == 1);
    for (int t : wings) {
      Vector3i half = mesh.triangles[t];
      for (int k = 0; k < 3; ++k)
        if (half[k] == a) half[k] = m;
      mesh.replace(t, b, m);
      mesh.add(half);
    }
  }
}

int collapse_short(EdgeMesh& mesh, const RemeshSettings& settings) {
  struct Short {
    double fraction;
    int a, b;
  };
  std::vector<Short> list;
  for (const auto& [a, b] : mesh.edges()) {
    const Vector3d middle = 0.5 * (mesh.position[a] + mesh.position[b]);
    const double fraction =
        (mesh.position[a] - mesh.position[b]).norm() / settings.edge_length(middle);
    if (fraction < 0.8) list.push_back({fraction, a, b});
  }
  std::sort(list.begin(), list.end(), [](const Short& l, const Short& r) {
    return std::tie(l.fraction, l.a, l.b) < std::tie(r.fraction, r.a, r.b);
  });
  int done = 0;
  std::vector<char> touched(mesh.vertices(),
                            0);  // one change per vertex and pass keeps lengths uniform
  for (const auto& s : list) {
    if (!mesh.alive(s.a) || !mesh.alive(s.b) || touched[s.a] || touched[s.b]) continue;
    // A border vertex is kept; an inner one is collapsed into it.
    int gone = s.a, kept = s.b;
    if (mesh.border[gone] && !mesh.border[kept]) std::swap(gone, kept);
    if (collapse(mesh, settings, gone, kept) ||
        (mesh.border[gone] == mesh.border[kept] && collapse(mesh, settings, kept, gone))) {
      touched[s.a] = touched[s.b] = 1;
      ++done;
    }
  }
  return done;
}

double smallest_angle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const auto angle = [](const Vector3d& u, const Vector3d& v) {
    return std::atan2(u.cross(v).norm(), u.dot(v));
  };
  return std::min({angle(b - a, c - a), angle(a - b, c - b), angle(a - c, b - c)});
}

void flip_edges(EdgeMesh& mesh) {
  for (const auto& [a, b] : mesh.edges()) {
    const auto wings = mesh.wings(a, b);
    if (wings.size() != 2) continue;
    const int c = mesh.third(wings[0], a, b), d = mesh.third(wings[1], a, b);
    if (c == d || !mesh.wings(c, d).empty()) continue;
    const auto& p = mesh.position;
    const double before =
        std::min(smallest_angle(p[a], p[b], p[c]), smallest_angle(p[a], p[b], p[d]));
    const double after =
        std::min(smallest_angle(p[c], p[d], p[a]), smallest_angle(p[c], p[d], p[b]));
    if (after <= before + 0.02) continue;
    // wings[0] has a, b, c in turn or b, a, c; the new pair keeps that orientation.
    Vector3i first = mesh.triangles[wings[0]], second = mesh.triangles[wings[1]];
    for (int k = 0; k < 3; ++k) {
      if (first[k] == b) first[k] = d;
      if (second[k] == a) second[k] = c;
    }
    const Vector3d n0 = mesh.area_normal(mesh.triangles[wings[0]]).normalized();
    const Vector3d n1 = mesh.area_normal(mesh.triangles[wings[1]]).normalized();
    const Vector3d m0 = mesh.area_normal(first).normalized(),
                   m1 = mesh.area_normal(second).normalized();
    const Vector3d mean = (n0 + n1).normalized();
    if (n0.dot(n1) < 0.5 || m0.dot(mean) < 0.5 || m1.dot(mean) < 0.5) continue;
    mesh.remove(wings[0]);
    mesh.remove(wings[1]);
    mesh.add(first);
    mesh.add(second);
  }
}

/// The open borders of the fine surface, for projection.
struct Outline {
  std::vector<std::array<Vector3d, 2>> pieces;

  Vector3d nearest(const Vector3d& p) const {
    double best = std::numeric_limits<double>::infinity();
    Vector3d found = p;
    for (const auto& [a, b] : pieces) {
      const Vector3d e = b - a;
      const double s = std::clamp((p - a).dot(e) / std::max(e.squaredNorm(), 1e-30), 0.0, 1.0);
      const Vector3d q = a + s * e;
      if ((p - q).squaredNorm() < best) {
        best = (p - q).squaredNorm();
        found = q;
      }
    }
    return found;
  }
};

void smooth(EdgeMesh& mesh, const TriangleTree& surface, const Outline& outline) {
  for (int v = 0; v < mesh.vertices(); ++v) {
    if (!mesh.alive(v) || mesh.pinned[v]) continue;
    Vector3d sum = Vector3d::Zero();
    double weight = 0;
    for (int n : mesh.neighbours(v)) {
      if (mesh.border[v] && mesh.wings(v, n).size() != 1) continue;
      sum += mesh.position[n];
      weight += 1;
    }
    if (weight < 2) continue;
    Vector3d step = sum / weight - mesh.position[v];
    Vector3d target;
    if (mesh.border[v]) {
      target = outline.nearest(mesh.position[v] + 0.5 * step);
    } else {
      const Vector3d n = mesh.normal(v);
      step -= n * n.dot(step);
      target = surface.nearest(mesh.position[v] + 0.7 * step).point;
    }
    if (keeps_facing(mesh, v, target, -1, -1)) mesh.position[v] = target;
  }
}

}  // namespace

Remeshed remesh(const TriMesh& fine, const RemeshSettings& settings) {
  assert(settings.edge_length);
  EdgeMesh mesh(fine);
  for (int v : settings.pinned) mesh.pinned[v] = 1;
  const TriangleTree surface(fine);
  Outline outline;
  for (const auto& [a, b] : mesh.edges())
    if (mesh.wings(a, b).size() == 1)
      outline.pieces.push_back({fine.vertices[a], fine.vertices[b]});

  // First to the target size by collapses and smoothing, then rounds of all four operations.
  for (int pass = 0; pass < 60; ++pass) {
    const int done = collapse_short(mesh, settings);
    flip_edges(mesh);
    if (done < 4) break;
  }
  for (int round = 0; round < settings.rounds; ++round) {
    split_long(mesh, settings);
    for (int pass = 0; pass < 4 && collapse_short(mesh, settings) > 0; ++pass) {
    }
    flip_edges(mesh);
    smooth(mesh, surface, outline);
    smooth(mesh, surface, outline);
  }

  Remeshed result;
  std::vector<int> index(mesh.vertices(), -1);
  for (int v = 0; v < mesh.vertices(); ++v)
    if (mesh.alive(v)) {
      index[v] = static_cast<int>(result.mesh.vertices.size());
      result.mesh.vertices.push_back(mesh.position[v]);
    }
  for (const auto& t : mesh.triangles)
    if (t[0] >= 0) result.mesh.triangles.emplace_back(index[t[0]], index[t[1]], index[t[2]]);
  for (int v : settings.pinned) result.pinned.push_back(index[v]);
  return result;
}

}  // namespace condyle
