#include "engine/field/isosurface.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <map>

#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

// Corner c of a cell lies at bits (x, y, z) = (c & 1, c >> 1 & 1, c >> 2).
constexpr std::array<std::array<int, 2>, 12> cell_edges = {{{0, 1},
                                                            {2, 3},
                                                            {4, 5},
                                                            {6, 7},  // x
                                                            {0, 2},
                                                            {1, 3},
                                                            {4, 6},
                                                            {5, 7},  // y
                                                            {0, 4},
                                                            {1, 5},
                                                            {2, 6},
                                                            {3, 7}}};  // z
// Corners of each face, counter-clockwise seen from outside the cell.
constexpr std::array<std::array<int, 4>, 6> cell_faces = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

int edge_between(int a, int b) {
  for (int e = 0; e < 12; ++e) {
    const auto [c, d] = cell_edges[static_cast<std::size_t>(e)];
    if ((a == c && b == d) || (a == d && b == c)) return e;
  }
  return -1;
}

bool share_face(int e, int f) {
  for (const auto& face : cell_faces) {
    const auto on = [&](int edge) {
      const auto [c, d] = cell_edges[static_cast<std::size_t>(edge)];
      return std::count(face.begin(), face.end(), c) && std::count(face.begin(), face.end(), d);
    };
    if (on(e) && on(f)) return true;
  }
  return false;
}

/// A closed polygon through cell edges; `fan` is the corner its triangles start from, or -1 when
/// every fan would have a diagonal in a cell face (the neighbour might have the same one): then a
/// middle vertex is used.
struct Loop {
  std::vector<int> edges;
  int fan = -1;
};

/// Polygons of each of the 256 sign patterns. On faces with two inside corners across, the inside
/// corners are kept apart; the rule depends on the face alone, so neighbours agree.
std::vector<std::vector<Loop>> make_loops() {
  std::vector<std::vector<Loop>> table(256);
  for (int pattern = 0; pattern < 256; ++pattern) {
    const auto inside = [&](int corner) { return (pattern >> corner & 1) != 0; };
    std::array<int, 12> next;
    next.fill(-1);
    for (const auto& face : cell_faces)
      for (std::size_t i = 0; i < 4; ++i) {
        if (inside(face[i]) || !inside(face[(i + 1) % 4])) continue;
        std::size_t j = i + 1;  // last of this run of inside corners
        while (inside(face[(j + 1) % 4])) ++j;
        const int enter = edge_between(face[i], face[(i + 1) % 4]);
        const int leave = edge_between(face[j % 4], face[(j + 1) % 4]);
        next[static_cast<std::size_t>(enter)] = leave;
      }
    std::array<bool, 12> used{};
    for (int start = 0; start < 12; ++start) {
      if (next[static_cast<std::size_t>(start)] < 0 || used[static_cast<std::size_t>(start)])
        continue;
      Loop loop;
      for (int e = start; !used[static_cast<std::size_t>(e)];
           e = next[static_cast<std::size_t>(e)]) {
        used[static_cast<std::size_t>(e)] = true;
        loop.edges.push_back(e);
      }
      const int n = static_cast<int>(loop.edges.size());
      for (int s = 0; s < n && loop.fan < 0; ++s) {
        bool clear = true;
        for (int i = 2; i + 1 < n; ++i)
          clear = clear && !share_face(loop.edges[static_cast<std::size_t>(s)],
                                       loop.edges[static_cast<std::size_t>((s + i) % n)]);
        if (clear) loop.fan = s;
      }
      table[static_cast<std::size_t>(pattern)].push_back(loop);
    }
  }
  return table;
}

/// Vertex numbers of the grid edges of two neighbouring sample layers (constant i).
class EdgeVertices {
 public:
  explicit EdgeVertices(const SampledField& field)
      : row_(field.axes[2].size()), layer_(row_ * field.axes[1].size() * 3) {
    for (auto& layer : ids_) layer.assign(layer_, -1);
  }
  int& at(const Vector3i& sample, int axis) {
    return ids_[sample.x() & 1][(static_cast<std::size_t>(sample.y()) * row_ +
                                 static_cast<std::size_t>(sample.z())) *
                                    3 +
                                static_cast<std::size_t>(axis)];
  }
  void forget(int i) { std::fill(ids_[i & 1].begin(), ids_[i & 1].end(), -1); }

 private:
  std::size_t row_, layer_;
  std::array<std::vector<int>, 2> ids_;
};

}  // namespace

TriMesh isosurface(const SampledField& field) {
  assert(field.size().minCoeff() >= 2);
  assert(field.values.size() == field.axes[0].size() * field.axes[1].size() * field.axes[2].size());
  static const auto loops = make_loops();
  TriMesh mesh;
  EdgeVertices vertices(field);
  std::array<std::size_t, 8> offset;
  for (int c = 0; c < 8; ++c)
    offset[static_cast<std::size_t>(c)] = field.index(c & 1, c >> 1 & 1, c >> 2);

  const auto vertex = [&](int i, int j, int k, int edge) {
    const auto [c, d] = cell_edges[static_cast<std::size_t>(edge)];
    const int axis = edge / 4;
    const Vector3i at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
    int& id = vertices.at(at, axis);
    if (id < 0) {
      const double a = field.values[field.index(at.x(), at.y(), at.z())];
      const double b = field.values[field.index(i + (d & 1), j + (d >> 1 & 1), k + (d >> 2))];
      // Kept off the corners, where triangles would shrink to nothing.
      const double t = std::clamp(a / (a - b), 0.03, 0.97);
      Vector3d p = field.position(at.x(), at.y(), at.z());
      p[axis] +=
          t * (field.axes[static_cast<std::size_t>(axis)][static_cast<std::size_t>(at[axis]) + 1] -
               p[axis]);
      id = static_cast<int>(mesh.vertices.size());
      mesh.vertices.push_back(p);
    }
    return id;
  };

  const Vector3i size = field.size();
  std::vector<int> corner;
  for (int i = 0; i + 1 < size.x(); ++i) {
    if (i > 0) vertices.forget(i + 1);
    for (int j = 0; j + 1 < size.y(); ++j)
      for (int k = 0; k + 1 < size.z(); ++k) {
        const float* value = &field.values[field.index(i, j, k)];
        unsigned pattern = 0;
        for (unsigned c = 0; c < 8; ++c) pattern |= (value[offset[c]] < 0 ? 1u : 0u) << c;
        if (pattern == 0 || pattern == 255) continue;
        for (const auto& loop : loops[pattern]) {
          corner.clear();
          for (const int edge : loop.edges) corner.push_back(vertex(i, j, k, edge));
          const std::size_t n = corner.size();
          if (loop.fan >= 0) {
            const auto s = static_cast<std::size_t>(loop.fan);
            for (std::size_t m = 1; m + 1 < n; ++m)
              mesh.triangles.emplace_back(corner[s], corner[(s + m) % n], corner[(s + m + 1) % n]);
          } else {
            Vector3d middle = Vector3d::Zero();
            for (const int v : corner) middle += mesh.vertices[static_cast<std::size_t>(v)];
            const int center = static_cast<int>(mesh.vertices.size());
            mesh.vertices.push_back(middle / static_cast<double>(n));
            for (std::size_t m = 0; m < n; ++m)
              mesh.triangles.emplace_back(center, corner[m], corner[(m + 1) % n]);
          }
        }
      }
  }
  return mesh;
}

TriMesh mirror_image(const TriMesh& mesh) {
  TriMesh image = mesh;
  for (auto& p : image.vertices) p.x() = -p.x();
  for (auto& t : image.triangles) std::swap(t[1], t[2]);
  return image;
}

TriMesh with_mirror_image(const TriMesh& half) {
  TriMesh whole = half;
  std::vector<int> twin(half.vertices.size());
  for (std::size_t i = 0; i < half.vertices.size(); ++i) {
    twin[i] = static_cast<int>(i);
    if (half.vertices[i].x() == 0) continue;
    twin[i] = static_cast<int>(whole.vertices.size());
    Vector3d p = half.vertices[i];
    p.x() = -p.x();
    whole.vertices.push_back(p);
    if (!half.colors.empty()) whole.colors.push_back(half.colors[i]);
  }
  const auto at = [&](int v) { return twin[static_cast<std::size_t>(v)]; };
  for (const auto& t : half.triangles) whole.triangles.emplace_back(at(t[0]), at(t[2]), at(t[1]));
  return whole;
}

TriMesh largest_piece(const TriMesh& mesh) {
  const Components components = find_components(mesh);
  std::vector<int> count(static_cast<std::size_t>(components.count), 0);
  for (const int c : components.of_triangle) ++count[static_cast<std::size_t>(c)];
  const auto largest = std::max_element(count.begin(), count.end()) - count.begin();
  TriMesh out;
  std::vector<int> number(mesh.vertices.size(), -1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (components.of_triangle[t] != largest) continue;
    Vector3i corner;
    for (int i = 0; i < 3; ++i) {
      const auto v = static_cast<std::size_t>(mesh.triangles[t][i]);
      if (number[v] < 0) {
        number[v] = static_cast<int>(out.vertices.size());
        out.vertices.push_back(mesh.vertices[v]);
        if (!mesh.colors.empty()) out.colors.push_back(mesh.colors[v]);
      }
      corner[i] = number[v];
    }
    out.triangles.push_back(corner);
  }
  return out;
}

TriMesh clipped(const TriMesh& mesh, const std::vector<double>& values) {
  assert(values.size() == mesh.vertices.size());
  TriMesh out;
  std::vector<int> kept(mesh.vertices.size(), -1);
  std::map<std::pair<int, int>, int> cuts;
  const auto value = [&](int v) { return values[static_cast<std::size_t>(v)]; };
  const auto keep = [&](int v) {
    int& id = kept[static_cast<std::size_t>(v)];
    if (id < 0) {
      id = static_cast<int>(out.vertices.size());
      out.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
    }
    return id;
  };
  const auto cut = [&](int a, int b) {
    const auto key = std::minmax(a, b);
    const auto [it, fresh] = cuts.try_emplace(key, static_cast<int>(out.vertices.size()));
    if (fresh) {
      const double t =
          std::clamp(value(key.first) / (value(key.first) - value(key.second)), 0.05, 0.95);
      out.vertices.push_back((1 - t) * mesh.vertices[static_cast<std::size_t>(key.first)] +
                             t * mesh.vertices[static_cast<std::size_t>(key.second)]);
    }
    return it->second;
  };
  for (const auto& triangle : mesh.triangles) {
    std::vector<int> polygon;
    for (int i = 0; i < 3; ++i) {
      const int a = triangle[i], b = triangle[(i + 1) % 3];
      if (value(a) < 0) polygon.push_back(keep(a));
      if ((value(a) < 0) != (value(b) < 0)) polygon.push_back(cut(a, b));
    }
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
      out.triangles.emplace_back(polygon[0], polygon[i], polygon[i + 1]);
  }
  return out;
}

}  // namespace condyle
