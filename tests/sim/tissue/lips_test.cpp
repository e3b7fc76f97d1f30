#include "sim/tissue/lips.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int columns = 61, rows = 41;

/// The front of a face, a sheet in the plane y = -100, with folds: every third vertex of the row
/// below the lip line lies beyond its neighbour, so that triangles at the line face backward.
TriMesh folded_sheet() {
  TriMesh sheet;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      Vector3d p(column - 30.0, -100, row - 20.0 + 0.1);
      if (row == 19 && column % 3 == 0) p += Vector3d(1.3, 0.4, 0.8);
      sheet.vertices.push_back(p);
    }
  for (int row = 0; row + 1 < rows; ++row)
    for (int column = 0; column + 1 < columns; ++column) {
      const int a = row * columns + column, b = a + 1, c = a + columns, d = c + 1;
      sheet.triangles.emplace_back(a, b, d);
      sheet.triangles.emplace_back(a, d, c);
    }
  return sheet;
}

TEST(Lips, FoldsAtTheLipLineDoNotJoinTheLips) {
  Landmarks landmarks;
  landmarks.points["stomion"] = {0, -100, 0};
  landmarks.points["right_cheilion"] = {-22, -100, 0};
  landmarks.points["left_cheilion"] = {22, -100, 0};
  TriMesh face = folded_sheet();
  int backward = 0;
  for (const auto& t : face.triangles) {
    const Vector3d &a = face.vertices[t[0]], &b = face.vertices[t[1]], &c = face.vertices[t[2]];
    backward += (b - a).cross(c - a).y() > 0 ? 1 : 0;
  }
  EXPECT_GE(backward, 20);
  std::vector<std::string> notes;
  const MouthOutline mouth = cut_lip_line(face, landmarks, {0, -95, -8}, notes);
  ASSERT_TRUE(mouth.found());
  EXPECT_NEAR(face.vertices[mouth.right_corner].x(), -22, 1.5);
  EXPECT_NEAR(face.vertices[mouth.left_corner].x(), 22, 1.5);
  EXPECT_EQ(border_loops(face).size(), 2u) << "the mouth and the sheet's own border";
  // No triangle has vertices of both lips.
  EXPECT_GE(mouth.upper.size(), 40u);
  std::vector<char> upper(face.vertices.size(), 0);
  for (const int v : mouth.upper) upper[v] = 1;
  const auto is_below = [](int v) { return v < 20 * columns; };
  for (const auto& t : face.triangles) {
    if (upper[t[0]] || upper[t[1]] || upper[t[2]]) {
      EXPECT_FALSE(is_below(t[0]) || is_below(t[1]) || is_below(t[2]));
    }
  }
}

}  // namespace
}  // namespace condyle
