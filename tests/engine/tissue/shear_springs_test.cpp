// Stacks of flat layers resist shear as isotropic tissue of the same moduli does.
#include "engine/tissue/shear_springs.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "tests/engine/tissue/elastic_block.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double linear = 1;  // springs as stiff in compression as in extension

std::vector<LayerMaterial> materials(int layers) {
  const std::array moduli = {0.04, 0.015, 0.025};
  std::vector<LayerMaterial> all;
  all.reserve(static_cast<std::size_t>(layers));
  for (int i = 0; i < layers; ++i)
    all.push_back({.modulus_MPa = moduli[static_cast<std::size_t>(i) % moduli.size()]});
  return all;
}

/// A slab of layers of different moduli, each of `flat` edges' height.
ElasticBlock slab(int layers, double flat, ShearSprings springs) {
  constexpr double edge = 9;
  ElasticBlock block = make_block({16, 18, layers, edge, flat * edge}, {}, linear);
  block.mesh =
      layered_mesh(block.triangles, layers + 1, block.rest, materials(layers), springs, linear);
  return block;
}

double shear_modulus(const LayerMaterial& material) {
  return material.modulus_MPa / (2 * (1 + material.poisson));
}

/// Energy of a slab, mJ, some of whose nodes are held where `to` takes their places (mm).
template <class Held, class To>
double energy_held(const ElasticBlock& block, Held&& held, To&& to) {
  ElasticBlock moved = block;
  MeshLoads loads;
  block.each_node([&](int node, const Vector3d& at) {
    if (held(at))
      hold(moved, loads, node, block.pose * Vector3d(to(at.cwiseProduct(block.size.mm()))), 1e3);
  });
  const Settled settled = settle(moved, loads);
  EXPECT_TRUE(settled.converged);
  return settled.energy;
}

/// Energy of a slab whose upper side is displaced against its lower one, over that of isotropic
/// layers one on another.
double shear_over_isotropic(const ElasticBlock& block, const Vector3d& along) {
  constexpr double gamma = 0.02;
  const double energy = energy_held(
      block, [](const Vector3d& at) { return at.z() == 0 || at.z() == 1; },
      [&](const Vector3d& p) -> Vector3d { return p + gamma * p.z() * along; });
  double yield = 0;
  for (const LayerMaterial& material : materials(block.size.layers))
    yield += 1 / shear_modulus(material);
  return energy / (0.5 * block.size.layers / yield * gamma * gamma * block.size.mm().prod());
}

/// The same of all nodes where the slab is stretched along itself.
double stretch_over_isotropic(const ElasticBlock& block, const Vector3d& along) {
  constexpr double strain = 0.01;
  const double energy = energy_held(
      block, [](const Vector3d&) { return true; },
      [&](const Vector3d& p) -> Vector3d { return p + strain * along.dot(p) * along; });
  double stiffness = 0;
  for (const LayerMaterial& material : materials(block.size.layers))
    stiffness += 3 * shear_modulus(material) + bulk_modulus_of_prisms(material);
  return energy / (0.5 * stiffness / block.size.layers * strain * strain * block.size.mm().prod());
}

class FlatLayers : public testing::TestWithParam<std::pair<int, double>> {};

TEST_P(FlatLayers, ResistShearAsIsotropicTissue) {
  const auto [layers, flat] = GetParam();
  const ElasticBlock without = slab(layers, flat, ShearSprings::none);
  const ElasticBlock with = slab(layers, flat, ShearSprings::over_layers);
  for (const Vector3d& along : {Vector3d(1, 0, 0), Vector3d(0, 1, 0)}) {
    const double missing = shear_over_isotropic(without, along);
    const double made = shear_over_isotropic(with, along);
    std::printf("%d layers of %.2f edges: shear %.2f without, %.2f with, stretch %.2f and %.2f\n",
                layers, flat, missing, made, stretch_over_isotropic(without, along),
                stretch_over_isotropic(with, along));
    EXPECT_LT(missing, 0.65);
    EXPECT_NEAR(made, 1, 0.15);
    EXPECT_NEAR(stretch_over_isotropic(with, along), 1, 0.15);
  }
}
INSTANTIATE_TEST_SUITE_P(ShearSprings, FlatLayers,
                         testing::Values(std::pair{3, 0.17}, std::pair{3, 0.25}, std::pair{3, 0.35},
                                         std::pair{2, 0.35}, std::pair{4, 0.25}, std::pair{5, 0.17},
                                         std::pair{5, 0.25}, std::pair{5, 0.35},
                                         std::pair{7, 0.25}));

TEST(ShearSprings, LayersOfEqualHeightAndEdgesNeedFewOfThem) {
  const ElasticBlock without = slab(3, 0.8, ShearSprings::none);
  const ElasticBlock with = slab(3, 0.8, ShearSprings::over_layers);
  const Vector3d along(1, 0, 0);
  EXPECT_NEAR(shear_over_isotropic(without, along), 1, 0.15);
  EXPECT_NEAR(shear_over_isotropic(with, along), 1, 0.15);
}

// Flat windows: more of these springs would be too stiff along the sheets.
TEST(ShearSprings, OverLessThanHalfAnEdgeAddOnlyPartOfWhatIsMissing) {
  const ElasticBlock block = slab(2, 0.17, ShearSprings::over_layers);
  for (const Vector3d& along : {Vector3d(1, 0, 0), Vector3d(0, 1, 0)}) {
    EXPECT_GT(shear_over_isotropic(block, along), 0.4);
    EXPECT_LT(stretch_over_isotropic(block, along), 1.35);
  }
}

TEST(ShearSprings, WindowsDivideTheLayers) {
  EXPECT_TRUE(layer_windows(1, 0.2).empty());
  for (int layers = 2; layers < 9; ++layers)
    for (const double flatness : {0.0, 0.1, 0.17, 0.25, 0.5, 1.0}) {
      int next = 0;
      for (const auto& [first, count] : layer_windows(layers, flatness)) {
        EXPECT_EQ(first, next);
        EXPECT_GE(count, 2) << layers << " " << flatness;
        if (flatness > 0.23) {
          EXPECT_LE(count, 3);
        }
        next += count;
      }
      EXPECT_EQ(next, layers);
    }
}

}  // namespace
}  // namespace condyle
