#include "tools/bench/baseline/synthetic_set.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "engine/tissue/harmonic_weights.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double area_mm2 = 11000, radius_mm = 70;  // a lower face's, and its curvature
const Vector3d hinge(0, 25, 45);

struct Sheet {
  std::vector<Vector2d> vertices;  // mm along the slab: to the left, and down; centred
  std::vector<Eigen::Vector3i> triangles;
  std::vector<char> rim;
};

/// A sheet with exactly these numbers of vertices: a grid, then its longest edges are halved, of
/// the rim until that is long enough, then inside.
Sheet make_sheet(int columns, int rim) {
  const int half = rim / 2;
  int across = std::max(1, half / 2);
  while (across > 1 && (across + 1) * (half - across + 1) > columns) --across;
  const int down = half - across;
  const double cell = std::sqrt(area_mm2 / (across * down));
  Sheet sheet;
  for (int j = 0; j <= down; ++j)
    for (int i = 0; i <= across; ++i) {
      sheet.vertices.emplace_back(cell * (i - 0.5 * across), cell * (j - 0.5 * down));
      sheet.rim.push_back(i == 0 || j == 0 || i == across || j == down);
    }
  for (int j = 0; j < down; ++j)
    for (int i = 0; i < across; ++i) {
      const int a = j * (across + 1) + i, b = a + 1, c = b + across + 1, d = c - 1;
      if ((i + j) % 2 == 0) {
        sheet.triangles.emplace_back(a, b, c);
        sheet.triangles.emplace_back(a, c, d);
      } else {
        sheet.triangles.emplace_back(a, b, d);
        sheet.triangles.emplace_back(b, c, d);
      }
    }
  int rim_now = 2 * (across + down);
  while (static_cast<int>(sheet.vertices.size()) < columns) {
    std::map<std::array<int, 2>, int> uses;
    for (const auto& t : sheet.triangles)
      for (int k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3];
        ++uses[{std::min(a, b), std::max(a, b)}];
      }
    const bool on_rim = rim_now < rim;
    std::array<int, 2> longest{-1, -1};
    double most = 0;
    for (const auto& [edge, count] : uses) {
      if ((count == 1) != on_rim) continue;
      const double length = (sheet.vertices[edge[1]] - sheet.vertices[edge[0]]).norm();
      if (length > most * (1 + 1e-9)) {
        most = length;
        longest = edge;
      }
    }
    const auto [a, b] = longest;
    const int middle = static_cast<int>(sheet.vertices.size());
    sheet.vertices.push_back(0.5 * (sheet.vertices[a] + sheet.vertices[b]));
    sheet.rim.push_back(on_rim);
    rim_now += on_rim;
    const std::size_t count = sheet.triangles.size();
    for (std::size_t i = 0; i < count; ++i)
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3i t = sheet.triangles[i];
        const int from = t[k], to = t[(k + 1) % 3];
        if (std::min(from, to) != a || std::max(from, to) != b) continue;
        sheet.triangles[i] = {from, middle, t[(k + 2) % 3]};
        sheet.triangles.emplace_back(middle, to, t[(k + 2) % 3]);
        break;
      }
  }
  return sheet;
}

}  // namespace

SyntheticSize table1_size() { return {}; }
SyntheticSize patient1_size() { return {251, 63, 2, 188, {0, 1, 2}}; }
SyntheticSize patient2_size() { return {523, 104, 3, 150, {0, 3}}; }

SyntheticSize size_of_nodes(int nodes) {
  const int side = static_cast<int>(std::lround(std::sqrt(nodes / 4.0)));
  const int columns = side * side, rim = 4 * (side - 1);
  return {columns, rim, 3, static_cast<int>(0.36 * (columns - rim)), {0, 3}};
}

SyntheticSet make_synthetic_set(const SyntheticSize& size) {
  const Sheet sheet = make_sheet(size.columns, size.rim);
  const LayerStack layers = default_layers(size.layers);
  SyntheticSet set;
  set.columns = size.columns;
  set.sheets = size.layers + 1;
  set.triangles = sheet.triangles;
  const auto height_of = [&](int column) { return -sheet.vertices[column].y(); };
  double half_height = 0;
  for (const auto& v : sheet.vertices) half_height = std::max(half_height, v.y());
  for (int c = 0; c < set.columns; ++c) {
    const double angle = sheet.vertices[c].x() / radius_mm;
    // Thicker in the middle, as a cheek is.
    const double depth = 9 + 5 * std::cos(1.57 * height_of(c) / half_height);
    double below = 0;
    for (int s = 0; s < set.sheets; ++s) {
      const double radius = radius_mm - below * depth;
      set.rest.emplace_back(radius * std::sin(angle), -radius * std::cos(angle), height_of(c));
      if (s < size.layers) below += layers.fraction[s];
    }
  }
  // The grid's rows run downwards: seen from outside its triangles would run clockwise.
  for (auto& t : set.triangles) std::swap(t[1], t[2]);
  set.mesh = layered_mesh(set.triangles, set.sheets, set.rest, layers.material);

  std::vector<int> given;
  std::vector<double> given_fraction;
  const auto anchor = [&](int node, bool moves, double stiffness) {
    set.mesh.anchor_node.push_back(node);
    set.mesh.anchor_stiffness.push_back(stiffness);
    set.anchor_moves.push_back(moves);
    given.push_back(node);
    given_fraction.push_back(moves ? 1 : 0);
  };
  std::vector<int> inside;
  for (int c = 0; c < set.columns; ++c)
    if (!sheet.rim[c]) inside.push_back(c);
  std::stable_sort(inside.begin(), inside.end(),
                   [&](int a, int b) { return std::abs(height_of(a)) > std::abs(height_of(b)); });
  inside.resize(std::min<std::size_t>(inside.size(), size.bone_springs));
  std::sort(inside.begin(), inside.end());
  for (int c : inside) anchor(node_of(c, size.layers, set.sheets), height_of(c) < 0, 2.0);
  for (int c = 0; c < set.columns; ++c)
    if (sheet.rim[c])
      for (int s : size.boundary_sheets)
        anchor(node_of(c, s, set.sheets), size.rim_moves && height_of(c) < hinge.z(), 2.0);
  set.node_fraction = harmonic_weights(set.mesh, given, given_fraction);
  set.anchor_offset.assign(set.mesh.anchor_node.size(), Vector3d::Zero());
  return set;
}

Pose synthetic_pose(double opening_rad, const Vector3d& moved_mm) {
  Pose pose;
  pose.R = Eigen::AngleAxisd(opening_rad, Vector3d::UnitX());
  pose.t = hinge - pose.R * hinge + moved_mm;
  return pose;
}

MeshLoads synthetic_loads(const SyntheticSet& set, const Pose& lower_bone) {
  MeshLoads loads;
  for (std::size_t i = 0; i < set.mesh.anchor_node.size(); ++i) {
    const Vector3d target = set.rest[set.mesh.anchor_node[i]] + set.anchor_offset[i];
    loads.anchor_target.push_back(set.anchor_moves[i] ? lower_bone * target : target);
  }
  return loads;
}

Nodes carried(const SyntheticSet& set, const Nodes& x, const Pose& from, const Pose& to) {
  const Pose motion = to * from.inverse();
  Nodes next = x;
  for (std::size_t i = 0; i < x.size(); ++i)
    next[i] += set.node_fraction[i] * (motion * x[i] - x[i]);
  return next;
}

}  // namespace condyle
