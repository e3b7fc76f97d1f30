#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <vector>

#include "engine/cut/cut.h"
#include "engine/mesh/measure.h"

namespace condyle::test {

/// Used vertices whose triangles are not one closed fan that turns one way: 0 on a closed manifold
/// whose neighbours agree on outside.
inline int broken_vertices(const TriMesh& mesh) {
  struct Side {
    int from, to;  // across from the vertex
  };
  std::vector<std::vector<Side>> at(mesh.vertices.size());
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) at[t[k]].push_back({t[(k + 1) % 3], t[(k + 2) % 3]});
  int broken = 0;
  for (const auto& sides : at) {
    if (sides.empty()) continue;
    std::size_t steps = 0;
    int here = sides[0].from;
    bool closed = true;
    do {
      int next = -1, ways = 0;
      for (const Side& side : sides)
        if (side.from == here) {
          next = side.to;
          ++ways;
        }
      closed = ways == 1;
      here = next;
      ++steps;
    } while (closed && here != sides[0].from && steps <= sides.size());
    broken += !closed || steps != sides.size();
  }
  return broken;
}

/// Every piece is closed and manifold, names the origin of its faces, and the volumes add up.
inline void expect_whole(const TriMesh& bone, const CutResult& result) {
  double sum = result.kerf_volume_mm3;
  for (std::size_t i = 0; i < result.pieces.size(); ++i) {
    const Piece& piece = result.pieces[i];
    EXPECT_EQ(broken_vertices(piece.mesh), 0) << "piece " << i;
    ASSERT_EQ(piece.source.size(), piece.mesh.triangles.size());
    ASSERT_EQ(piece.wall.size(), piece.mesh.triangles.size());
    for (std::size_t t = 0; t < piece.source.size(); ++t)
      ASSERT_NE(piece.source[t] >= 0, piece.wall[t] >= 0) << "piece " << i << ", face " << t;
    EXPECT_NEAR(piece.volume_mm3, signed_volume(piece.mesh), 1e-9 * std::abs(piece.volume_mm3));
    sum += piece.volume_mm3;
  }
  const double whole = signed_volume(bone);
  EXPECT_NEAR(sum, whole, 1e-6 * whole);
}

/// Triangles out of reach of all cuts, each beyond one plane of it, are those of the bone, corner
/// by corner.
inline void expect_kept(const TriMesh& bone, std::span<const Cut> cuts, const CutResult& result) {
  std::vector<int> missed_by(bone.triangles.size(), 0);  // cuts
  for (const Cut& cut : cuts) {
    std::vector<char> far(bone.triangles.size(), 0);
    for (const Plane& plane : cut.reach) {
      std::vector<char> beyond(bone.vertices.size());
      for (std::size_t v = 0; v < beyond.size(); ++v)
        beyond[v] = plane.distance(bone.vertices[v]) > 1e-6;
      for (std::size_t t = 0; t < far.size(); ++t) {
        const auto& v = bone.triangles[t];
        far[t] |= beyond[v[0]] && beyond[v[1]] && beyond[v[2]];
      }
    }
    for (std::size_t t = 0; t < far.size(); ++t) missed_by[t] += far[t];
  }
  const auto is_far = [&](int t) { return missed_by[t] == static_cast<int>(cuts.size()); };
  std::vector<int> found(bone.triangles.size(), 0);
  int moved = 0, lost = 0;
  for (const Piece& piece : result.pieces)
    for (std::size_t i = 0; i < piece.source.size(); ++i) {
      const int source = piece.source[i];
      if (source < 0 || !is_far(source)) continue;
      ++found[source];
      for (int k = 0; k < 3; ++k)
        moved += piece.mesh.vertices[piece.mesh.triangles[i][k]] !=
                 bone.vertices[bone.triangles[source][k]];
    }
  for (int t = 0; t < static_cast<int>(found.size()); ++t) lost += is_far(t) && found[t] != 1;
  EXPECT_EQ(moved, 0) << "corners of triangles out of reach";
  EXPECT_EQ(lost, 0) << "triangles out of reach that are not there once";
}

}  // namespace condyle::test
