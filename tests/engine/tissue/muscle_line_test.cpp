#include "engine/tissue/muscle_line.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/minimize/minimize.h"
#include "engine/tissue/hessian_factor.h"
#include "engine/tissue/layered_mesh.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

TEST(MuscleLine, PullsUpToItsLimitAndNeverPushes) {
  MuscleLine muscle;
  muscle.shortest = 40;
  muscle.stiffness = 0.8;
  muscle.limit = 4;
  EXPECT_EQ(muscle.law(39).tension, 0);
  EXPECT_EQ(muscle.law(39).energy, 0);
  EXPECT_DOUBLE_EQ(muscle.law(42).tension, 1.6);
  EXPECT_DOUBLE_EQ(muscle.law(45).tension, 4);
  EXPECT_DOUBLE_EQ(muscle.law(80).tension, 4);
  for (double length = 39; length < 47; length += 0.1) {  // the tension is the energy's slope
    const double h = 1e-4,
                 slope = (muscle.law(length + h).energy - muscle.law(length - h).energy) / (2 * h);
    EXPECT_NEAR(muscle.law(length).tension, slope, 1e-4) << length;
  }
  muscle.limit = 0;  // at rest
  EXPECT_EQ(muscle.law(80).tension, 0);
  EXPECT_EQ(muscle.law(80).energy, 0);
}

/// A bent line whose points lie between nodes, with either law.
MuscleLine bent_line(bool hill) {
  MuscleLine muscle;
  muscle.points = {{.fixed = {0, 0, 12}},
                   {.node = {0, 1}, .weight = {0.3, 0.7}},
                   {.node = {1, 2, 3}, .weight = {0.2, 0.5, 0.3}},
                   {.node = {3}, .weight = {1}}};
  muscle.limit = 4;
  if (hill)
    muscle.optimal = 48;
  else
    muscle.shortest = 34, muscle.stiffness = 0.3;
  return muscle;
}

TEST(MuscleLine, GradientAndCurvatureAreThoseOfTheEnergy) {
  const Points x{{6, 1, 9}, {14, -2, 5}, {27, 3, 6}, {39, 5, -3}};
  const Points d{{0.3, -0.6, 0.2}, {-0.5, 0.4, 0.9}, {0.8, 0.1, -0.3}, {-0.2, 0.7, 0.6}};
  for (const bool hill : {false, true}) {
    const MuscleLine muscle = bent_line(hill);
    ASSERT_GT(muscle.law(muscle.length(x)).tension, 0.5) << hill;
    const auto along = [&](double s) {
      Points moved = x;
      for (std::size_t i = 0; i < x.size(); ++i) moved[i] += s * d[i];
      return moved;
    };
    const auto slope = [&](double s) {
      double sum = 0;
      const double energy = muscle.energy_and_gradient(
          along(s), [&](int node, const Vector3d& g) { sum += g.dot(d[node]); });
      EXPECT_EQ(energy, muscle.energy(along(s)));
      return sum;
    };
    const double h = 1e-4;
    const double by_energy = (muscle.energy(along(h)) - muscle.energy(along(-h))) / (2 * h);
    EXPECT_NEAR(slope(0), by_energy, 1e-6) << hill;
    const double by_slope = (slope(h) - slope(-h)) / (2 * h);
    EXPECT_NEAR(muscle.curvature(x, d), by_slope, 1e-6) << hill;
    EXPECT_GT(std::abs(by_slope), 0.01) << hill;
  }
}

TEST(MuscleLine, HillsTensionIsTheLimitAtTheOptimalLengthAndFallsOff) {
  MuscleLine muscle;
  muscle.optimal = 50;
  muscle.limit = 3;
  EXPECT_DOUBLE_EQ(muscle.law(50).tension, 3);
  EXPECT_NEAR(muscle.law(35).tension, 3 * std::exp(-0.09 / 0.45), 1e-12);
  EXPECT_NEAR(muscle.law(65).tension, muscle.law(35).tension, 1e-12);
  for (double length = 10; length < 90; length += 5) {
    const double h = 1e-3;
    EXPECT_NEAR((muscle.law(length + h).energy - muscle.law(length - h).energy) / (2 * h),
                muscle.law(length).tension, 1e-6);
    EXPECT_NEAR((muscle.law(length + h).tension - muscle.law(length - h).tension) / (2 * h),
                muscle.law(length).rise, 1e-6);
  }
  EXPECT_NEAR(muscle.law(0).energy, 0, 1e-12);
}

/// A block of tissue on bone, with a muscle from a fixed place to its free skin.
struct PulledBlock {
  static constexpr int side = 7, sheets = 3;
  Nodes rest;
  SpringPrismMesh mesh;
  MeshLoads loads;
  int pulled = 0;

  PulledBlock() {
    std::vector<Eigen::Vector3i> triangles;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i)
        for (int s = 0; s < sheets; ++s) rest.emplace_back(8.0 * i, 8.0 * j, -5.0 * s);
    for (int j = 0; j + 1 < side; ++j)
      for (int i = 0; i + 1 < side; ++i) {
        const int a = j * side + i;
        triangles.emplace_back(a, a + 1, a + side + 1);
        triangles.emplace_back(a, a + side + 1, a + side);
      }
    mesh = layered_mesh(triangles, sheets, rest, std::vector<LayerMaterial>(sheets - 1));
    for (int c = 0; c < side * side; ++c) {
      mesh.anchor_node.push_back(node_of(c, sheets - 1, sheets));
      mesh.anchor_stiffness.push_back(1.0);
      loads.anchor_target.push_back(rest[mesh.anchor_node.back()]);
    }
    pulled = node_of(side * side / 2, 0, sheets);
  }
  /// `excitation`: 0 to 1.
  void excite(double excitation, double limit_N) {
    const Vector3d origin = rest[pulled] + Vector3d(50, 0, 10);
    MuscleLine muscle{{{.fixed = origin}, {.node = {pulled}, .weight = {1}}}};
    const double length = (rest[pulled] - origin).norm();
    muscle.shortest = (1 - 0.2 * excitation) * length;
    muscle.stiffness = limit_N / (0.1 * length);
    muscle.limit = excitation * limit_N;
    loads.muscles = {muscle};
  }
  Nodes equilibrium(int* iterations = nullptr) const {
    Nodes x = rest;
    SpringPrismEnergy energy(mesh, loads, 1);
    MinimizeSettings settings;
    settings.tolerance_mm = 1e-6;
    settings.max_iterations = 500;
    const HessianFactor factor(mesh, loads, sheets, x);
    const MinimizeResult result = minimize(energy, factor, settings, x);
    EXPECT_TRUE(result.converged());
    if (iterations) *iterations = result.iterations;
    return x;
  }
};

TEST(MuscleLine, WithoutExcitationRestStaysRestBitForBit) {
  PulledBlock block;
  const Nodes without = block.equilibrium();
  block.excite(0, 3);
  const Nodes with = block.equilibrium();
  for (std::size_t i = 0; i < with.size(); ++i) EXPECT_EQ(with[i], without[i]);
}

TEST(MuscleLine, DrawsTheTissueTowardsItsOriginWithItsTension) {
  double last = 0;
  for (const double excitation : {0.25, 0.5, 1.0}) {
    PulledBlock block;
    block.excite(excitation, 0.2);
    const Nodes x = block.equilibrium();
    const Vector3d way = x[block.pulled] - block.rest[block.pulled];
    const MuscleLine& muscle = block.loads.muscles.front();
    const Vector3d span = muscle.points[1].at(x) - muscle.points[0].fixed;
    EXPECT_GT(way.dot(-span.normalized()), last + 0.05) << excitation;
    last = way.dot(-span.normalized());
    // The anchors hold what the muscle pulls with.
    Vector3d held = Vector3d::Zero();
    for (std::size_t i = 0; i < block.mesh.anchor_node.size(); ++i)
      held += 2 * block.mesh.anchor_stiffness[i] *
              (block.loads.anchor_target[i] - x[block.mesh.anchor_node[i]]);
    const double tension = muscle.law(span.norm()).tension;
    EXPECT_NEAR(held.dot(span.normalized()), tension, 1e-4 * tension);
    EXPECT_LE(tension, muscle.limit);
  }
}

/// However strong, it shortens no further than to its shortest length.
TEST(MuscleLine, ShortensWithinItsBound) {
  PulledBlock block;
  block.excite(0.25, 500);
  const Nodes x = block.equilibrium();
  const MuscleLine& muscle = block.loads.muscles.front();
  EXPECT_GE(muscle.length(x), muscle.shortest);
  EXPECT_LT(muscle.length(x), 1.1 * muscle.shortest);
}

}  // namespace
}  // namespace condyle
