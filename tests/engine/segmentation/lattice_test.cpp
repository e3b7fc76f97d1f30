// Distances and pieces on lattices, against plain loops.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "engine/segmentation/distance_map.h"
#include "engine/segmentation/voxel_pieces.h"

namespace condyle {
namespace {

TEST(DistanceMap, EqualsThePlainSearch) {
  const std::array<int, 3> size = {13, 9, 7};
  const Eigen::Vector3d step(0.7, 1.1, 2);
  std::mt19937 random(4);
  std::vector<Eigen::Vector3d> features;
  std::vector<float> map;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i) {
        const bool feature = random() % 40 == 0;
        map.push_back(feature ? 0 : no_feature);
        if (feature) features.push_back(step.cwiseProduct(Eigen::Vector3d(i, j, k)));
      }
  ASSERT_GT(features.size(), 5u);
  make_squared_distances(map, size, step, 2);
  std::size_t q = 0;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i, ++q) {
        double nearest = 1e9;
        for (const auto& f : features)
          nearest =
              std::min(nearest, (f - step.cwiseProduct(Eigen::Vector3d(i, j, k))).squaredNorm());
        EXPECT_NEAR(map[q], nearest, 1e-4);
      }
  std::vector<float> none(map.size(), no_feature);
  make_squared_distances(none, size, step, 2);
  EXPECT_EQ(none, std::vector<float>(map.size(), no_feature));
}

TEST(VoxelPieces, JoinByFacesOrCorners) {
  // Two voxels that share a corner, one that shares a face, one apart, at the border.
  const std::array<int, 3> size = {5, 5, 4};
  std::vector<std::uint8_t> mask(100, 0);
  const auto at = [&](int i, int j, int k) -> std::uint8_t& { return mask[(k * 5 + j) * 5 + i]; };
  at(1, 1, 1) = at(2, 2, 2) = at(2, 3, 2) = at(4, 1, 1) = 1;
  const VoxelPieces faces = find_pieces(mask, size, 1, Connectivity::faces);
  EXPECT_EQ(faces.voxels, (std::vector<std::size_t>{1, 1, 2}));
  EXPECT_EQ(faces.at_border, (std::vector<std::uint8_t>{0, 1, 0}));
  const VoxelPieces corners = find_pieces(mask, size, 1, Connectivity::corners);
  EXPECT_EQ(corners.voxels, (std::vector<std::size_t>{3, 1}));
}

}  // namespace
}  // namespace condyle
