// The same layers mean the same tissue at any mesh size.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/math/pose.h"
#include "engine/tissue/layered_mesh.h"
#include "engine/tissue/refactorization.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// A bent patch the size of a lower face over two bones, in `cells` x `cells` squares. The upper
/// third grows on the upper bone and the lower third on the lower one; along the rim the attachment
/// changes from one to the other.
struct FacePatch {
  int cells, sheets;
  std::vector<Eigen::Vector3i> triangles;
  Nodes rest;
  SpringPrismMesh mesh;
  std::vector<double> fraction;  // per anchor, of the lower bone's displacement
};

FacePatch make_patch(int cells, const LayerStack& layers) {
  FacePatch patch{cells, static_cast<int>(layers.fraction.size()) + 1, {}, {}, {}, {}};
  const int n = cells + 1;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double angle = 1.5 * (static_cast<double>(i) / cells - 0.5);
      const double z = 105 * (0.5 - static_cast<double>(j) / cells);
      const double depth = 9 + 5 * std::cos(3.1 * z / 105);
      double below = 0;
      for (int s = 0; s < patch.sheets; ++s) {
        const double radius = 70 - below * depth;
        patch.rest.emplace_back(radius * std::sin(angle), -radius * std::cos(angle), z);
        if (s + 1 < patch.sheets) below += layers.fraction[s];
      }
    }
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const int a = j * n + i, b = a + 1, d = a + n, c = d + 1;
      if ((i + j) % 2 == 0) {
        patch.triangles.emplace_back(a, c, b);
        patch.triangles.emplace_back(a, d, c);
      } else {
        patch.triangles.emplace_back(a, d, b);
        patch.triangles.emplace_back(b, d, c);
      }
    }
  patch.mesh = layered_mesh(patch.triangles, patch.sheets, patch.rest, layers.material);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const bool rim = i == 0 || j == 0 || i == cells || j == cells;
      if (!rim && 3 * j > cells && 3 * j < 2 * cells) continue;
      const double position = std::clamp(3.0 * j / cells - 1, 0.0, 1.0);
      for (int s = rim ? 0 : patch.sheets - 1; s < patch.sheets; ++s) {
        patch.mesh.anchor_node.push_back(node_of(j * n + i, s, patch.sheets));
        patch.mesh.anchor_stiffness.push_back(2);
        patch.fraction.push_back(position * position * (3 - 2 * position));
      }
    }
  return patch;
}

/// Displacements of the skin with the lower bone moved.
Nodes skin_moved(const FacePatch& patch, const Pose& bone) {
  MeshLoads rest_loads, loads;
  for (std::size_t i = 0; i < patch.fraction.size(); ++i) {
    const Vector3d& p = patch.rest[patch.mesh.anchor_node[i]];
    rest_loads.anchor_target.push_back(p);
    loads.anchor_target.push_back(p + patch.fraction[i] * (bone * p - p));
  }
  const HessianFactor factor(patch.mesh, rest_loads, 1, patch.rest);
  SpringPrismEnergy energy(patch.mesh, loads, 1);
  Nodes x = patch.rest;
  EXPECT_TRUE(minimize_with_refactorization(patch.mesh, loads, energy, factor, {}, x).converged());
  Nodes moved;
  for (std::size_t i = 0; i < x.size(); i += patch.sheets) moved.push_back(x[i] - patch.rest[i]);
  return moved;
}

TEST(Refinement, FromTwoToTwentyThousandNodesMovesTheSkinByLessThanFivePercent) {
  const LayerStack layers = default_layers(3);
  const FacePatch coarse = make_patch(21, layers);
  const FacePatch fine = make_patch(48, split_layers(layers, 14, 105.0 / 48));
  EXPECT_NEAR(coarse.mesh.node_count, 2000, 100);
  EXPECT_NEAR(fine.mesh.node_count, 20000, 2000);
  Pose bone;  // opened by 3 degrees about a hinge behind, 2 mm forward and 1 mm down
  const Vector3d hinge(0, 25, 45);
  bone.R = Eigen::AngleAxisd(0.05, Vector3d::UnitX());
  bone.t = hinge - bone.R * hinge + Vector3d(0, -2, -1);
  const Nodes a = skin_moved(coarse, bone), b = skin_moved(fine, bone);

  // The fine skin at the coarse one's nodes.
  const auto fine_at = [&](double u, double v) {
    const int i = std::min(static_cast<int>(u), fine.cells - 1);
    const int j = std::min(static_cast<int>(v), fine.cells - 1);
    const Vector3d* p = &b[j * (fine.cells + 1) + i];
    const double s = u - i, t = v - j;
    return Vector3d((1 - t) * ((1 - s) * p[0] + s * p[1]) +
                    t * ((1 - s) * p[fine.cells + 1] + s * p[fine.cells + 2]));
  };
  double difference = 0, whole = 0, most = 0, farthest = 0;
  for (int j = 0; j <= coarse.cells; ++j)
    for (int i = 0; i <= coarse.cells; ++i) {
      const double scale = static_cast<double>(fine.cells) / coarse.cells;
      const Vector3d there = fine_at(scale * i, scale * j);
      const double apart = (a[j * (coarse.cells + 1) + i] - there).norm();
      difference += apart * apart;
      whole += there.squaredNorm();
      most = std::max(most, apart);
      farthest = std::max(farthest, there.norm());
    }
  std::printf("refined from %d to %d nodes: %.1f %% of the displacement, worst %.1f %%\n",
              coarse.mesh.node_count, fine.mesh.node_count, 100 * std::sqrt(difference / whole),
              100 * most / farthest);
  EXPECT_GT(farthest, 5);
  EXPECT_LT(std::sqrt(difference / whole), 0.05);
}

TEST(Refinement, LayersAreSplitOnlyWhereCellsWouldBeTall) {
  const LayerStack layers = default_layers(3);
  EXPECT_EQ(split_layers(layers, 14, 6).fraction.size(), 3u);
  const LayerStack split = split_layers(layers, 14, 2);
  double sum = 0, heaviest = 0;
  for (std::size_t i = 0; i < split.fraction.size(); ++i) {
    sum += split.fraction[i];
    heaviest = std::max(heaviest, split.fraction[i] * 14);
  }
  EXPECT_NEAR(sum, 1, 1e-12);
  EXPECT_LE(heaviest, 1.2 * 2 + 1e-12);
  EXPECT_EQ(split.material.size(), split.fraction.size());
  EXPECT_EQ(split.material.front().modulus_MPa, layers.material.front().modulus_MPa);
  EXPECT_EQ(split.material.back().modulus_MPa, layers.material.back().modulus_MPa);
  EXPECT_GT(split.fraction.size(), 5u);
  const LayerStack few = split_layers(layers, 14, 2, 5);
  EXPECT_EQ(few.fraction.size(), 5u);
  EXPECT_NEAR(std::accumulate(few.fraction.begin(), few.fraction.end(), 0.0), 1, 1e-12);
  EXPECT_EQ(split_layers(default_layers(5), 14, 0.5, 3).fraction.size(), 5u);
}

}  // namespace
}  // namespace condyle
