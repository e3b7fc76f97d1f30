#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <unordered_map>
#include <utility>

#include "engine/core/disjoint_sets.h"
#include "engine/cut/edge_key.h"
#include "engine/cut/part_faces.h"

namespace condyle {
namespace {

using Faces = std::vector<PartFace>;

struct Corner {
  int face, at;  // the edge from corner `at` to the next
};

/// Faces at an edge in pairs: solid lies between the two of a pair.
struct EdgePairs {
  std::uint64_t edge;
  std::vector<std::pair<Corner, Corner>> pairs;
};

std::vector<std::vector<Corner>> faces_by_edge(const Faces& faces) {
  std::vector<std::pair<std::uint64_t, Corner>> all;
  all.reserve(3 * faces.size());
  for (int i = 0; i < static_cast<int>(faces.size()); ++i)
    for (int k = 0; k < 3; ++k)
      all.push_back({edge_key(faces[i].vertices[k], faces[i].vertices[(k + 1) % 3]), {i, k}});
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::vector<Corner>> edges;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == 0 || all[i].first != all[i - 1].first) edges.emplace_back();
    edges.back().push_back(all[i].second);
  }
  return edges;
}

/// Pairs the faces at one edge of more than two: sorted by angle about it, each that faces one way
/// with the next that faces the other way across the solid between them.
std::vector<std::pair<Corner, Corner>> pair_faces(const Faces& faces,
                                                  const std::vector<Corner>& corners,
                                                  const std::vector<Eigen::Vector3d>& vertices) {
  const auto& first = faces[corners[0].face].vertices;
  const int low = std::min(first[corners[0].at], first[(corners[0].at + 1) % 3]),
            high = std::max(first[corners[0].at], first[(corners[0].at + 1) % 3]);
  const Eigen::Vector3d axis = (vertices[high] - vertices[low]).normalized(),
                        right = axis.unitOrthogonal(), up = axis.cross(right);
  struct Spoke {
    double angle;
    bool forward;  // traverses the edge from low to high: the solid lies clockwise of it
    Corner corner;
  };
  std::vector<Spoke> spokes;
  for (const Corner& corner : corners) {
    const auto& v = faces[corner.face].vertices;
    const Eigen::Vector3d out = vertices[v[(corner.at + 2) % 3]] - vertices[low];
    spokes.push_back({std::atan2(up.dot(out), right.dot(out)), v[corner.at] == low, corner});
  }
  std::stable_sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) {
    return std::pair(a.angle, a.forward) < std::pair(b.angle, b.forward);
  });
  // A face that runs forward has its normal counter-clockwise: the solid is entered at a backward
  // spoke and left at the next forward one. Where rounding mixes them, any order still pairs all.
  std::vector<std::pair<Corner, Corner>> pairs;
  std::vector<char> used(spokes.size(), false);
  for (std::size_t i = 0; i < spokes.size(); ++i) {
    if (spokes[i].forward) continue;
    for (std::size_t step = 1; step < spokes.size(); ++step) {
      const std::size_t j = (i + step) % spokes.size();
      if (used[j] || !spokes[j].forward) continue;
      used[i] = used[j] = true;
      pairs.push_back({spokes[i].corner, spokes[j].corner});
      break;
    }
  }
  return pairs;
}

/// Drops faces that lie back to back on the same corners, a flap without thickness, where they
/// share an edge with others. Returns whether there were any.
bool drop_flaps(Faces& faces, const std::vector<std::vector<Corner>>& edges) {
  std::vector<char> is_gone(faces.size(), false);
  bool any = false;
  const auto opposite = [&](const Corner& corner) {
    return faces[corner.face].vertices[(corner.at + 2) % 3];
  };
  for (const auto& corners : edges) {
    if (corners.size() <= 2) continue;
    for (std::size_t i = 0; i < corners.size(); ++i)
      for (std::size_t j = i + 1; j < corners.size(); ++j) {
        const Corner &a = corners[i], &b = corners[j];
        if (is_gone[a.face] || is_gone[b.face] || opposite(a) != opposite(b) ||
            faces[a.face].vertices[a.at] == faces[b.face].vertices[b.at])
          continue;
        is_gone[a.face] = is_gone[b.face] = any = true;
      }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (!is_gone[i]) faces[kept++] = faces[i];
  faces.resize(kept);
  return any;
}

/// Divides a face at the middle of one of its edges.
void divide(Faces& faces, Corner corner, int middle) {
  PartFace& face = faces[corner.face];
  const int a = face.vertices[corner.at], b = face.vertices[(corner.at + 1) % 3],
            c = face.vertices[(corner.at + 2) % 3];
  const PartFace second{{middle, b, c}, face.source, face.wall};
  face.vertices = {a, middle, c};
  faces.push_back(second);
}

/// Gives edges of several sheets a middle for each, so that none of their halves is shared; one
/// edge of a face at a time. Returns whether there were such edges.
bool divide_shared_edges(Faces& faces, const std::vector<std::vector<Corner>>& edges,
                         std::vector<Eigen::Vector3d>& vertices, std::vector<VertexCopy>& copies) {
  std::vector<std::pair<std::pair<int, int>, std::vector<std::pair<Corner, Corner>>>> shared;
  for (const auto& corners : edges) {
    if (corners.size() <= 2) continue;
    const auto& v = faces[corners[0].face].vertices;
    shared.push_back({std::minmax({v[corners[0].at], v[(corners[0].at + 1) % 3]}),
                      pair_faces(faces, corners, vertices)});
  }
  std::vector<char> was_divided(faces.size(), false);
  for (const auto& [edge, pairs] : shared)
    for (const auto& [a, b] : pairs) {
      if (was_divided[a.face] || was_divided[b.face]) continue;
      was_divided[a.face] = was_divided[b.face] = true;
      const int middle = static_cast<int>(vertices.size());
      vertices.push_back(0.5 * (vertices[edge.first] + vertices[edge.second]));
      copies.push_back({edge.first, edge.second});
      divide(faces, a, middle);
      divide(faces, b, middle);
    }
  return !shared.empty();
}

}  // namespace

void part_touching_sheets(Faces& faces, std::vector<Eigen::Vector3d>& vertices,
                          std::vector<VertexCopy>& copies) {
  constexpr int most_rounds = 12;  // each halves the faces at an edge; one or two are usual
  auto edges = faces_by_edge(faces);
  for (int round = 0; round < most_rounds; ++round) {
    if (drop_flaps(faces, edges)) edges = faces_by_edge(faces);
    if (!divide_shared_edges(faces, edges, vertices, copies)) break;
    edges = faces_by_edge(faces);
  }
  // Each fan of faces at a vertex gets its own copy of it.
  DisjointSets sets(3 * faces.size());  // of face corners
  for (const auto& corners : edges) {
    if (corners.size() != 2) continue;
    const auto [a, b] = std::pair(corners[0], corners[1]);
    // Opposite senses: the start of one is the end of the other.
    sets.join(3 * a.face + a.at, 3 * b.face + (b.at + 1) % 3);
    sets.join(3 * a.face + (a.at + 1) % 3, 3 * b.face + b.at);
  }
  std::unordered_map<int, int> fan_of_vertex;  // the first
  std::unordered_map<int, int> copy_of_fan;
  for (int i = 0; i < static_cast<int>(faces.size()); ++i)
    for (int k = 0; k < 3; ++k) {
      int& v = faces[i].vertices[k];
      const int fan = sets.find(3 * i + k);
      if (fan_of_vertex.try_emplace(v, fan).first->second == fan) continue;
      const auto [at, is_new] = copy_of_fan.try_emplace(fan, static_cast<int>(vertices.size()));
      if (is_new) {
        const Eigen::Vector3d p = vertices[v];
        vertices.push_back(p);
        copies.push_back({v, v});
      }
      v = at->second;
    }
}

}  // namespace condyle
