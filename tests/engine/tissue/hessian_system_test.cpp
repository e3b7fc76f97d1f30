#include "tools/bench/baseline/hessian_system.h"

#include <gtest/gtest.h>

#include <random>

#include "engine/tissue/hessian_factor.h"
#include "tools/bench/baseline/synthetic_set.h"

namespace condyle {
namespace {

using Flat = Eigen::Map<const Eigen::VectorXd>;

Flat flat(const Nodes& x) { return {x.front().data(), static_cast<Eigen::Index>(3 * x.size())}; }

/// A tissue away from rest.
struct Sample {
  SyntheticSet set = make_synthetic_set(table1_size());
  MeshLoads loads = synthetic_loads(set, synthetic_pose(0.05, {0, 0, 0}));
  Nodes x = set.rest, d = set.rest;

  Sample() {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> entry(-0.2, 0.2);
    for (auto& p : x) p += Eigen::Vector3d(entry(random), entry(random), entry(random));
    for (auto& p : d) p = {entry(random), entry(random), entry(random)};
    const auto& corner = set.mesh.prisms[40];
    MuscleLine muscle{{{{corner[0], corner[1]}, {0.6, 0.4}}, {{corner[5]}, {1}}}};
    muscle.shortest = 0.5 * muscle.length(x);
    muscle.stiffness = 2;
    muscle.limit = 0.3 * muscle.length(x);
    loads.muscles.push_back(muscle);
  }
};

// The matrix that other libraries get is the energy's own, by its curvature along any direction.
TEST(HessianSystem, HasTheCurvatureOfTheEnergy) {
  const Sample s;
  const HessianSystem system(s.set.mesh, s.loads, s.set.sheets, s.x);
  SpringPrismEnergy energy(s.set.mesh, s.loads, 1);
  Nodes gradient;
  energy.value_and_gradient(s.x, gradient);
  const double expected = energy.curvature(s.x, s.d).gauss_newton;
  const Eigen::VectorXd d = flat(s.d), size = d.cwiseAbs();
  const double found = d.dot(system.lower().selfadjointView<Eigen::Lower>() * d);
  // In single precision a coordinate of 100 mm is known to 8e-6 mm, and an edge of 1 mm no better.
  constexpr double precision = 1e-5;
  const Eigen::SparseMatrix<double> entries = system.lower().cwiseAbs();
  const double sum = size.dot(entries.selfadjointView<Eigen::Lower>() * size);
  EXPECT_GT(expected, 1);
  EXPECT_NEAR(found, expected, precision * sum);
  EXPECT_LT(sum, 10 * expected) << "the bound says something";
}

// The engine's factor of it is the factor that the minimiser gets.
TEST(HessianSystem, FactorsAsTheProductDoes) {
  const Sample s;
  const HessianSystem system(s.set.mesh, s.loads, s.set.sheets, s.x);
  BlockCholesky factor = system.empty_factor();
  EXPECT_EQ(system.factorize(factor, 1), 0);
  const auto& order = factor.tree().order.at;
  const int block = factor.tree().block;
  std::vector<float> b;
  for (const int column : order)
    for (int i = 0; i < block; ++i) b.push_back(static_cast<float>(flat(s.d)[column * block + i]));
  factor.solve(b, 1);
  Nodes z;
  HessianFactor(s.set.mesh, s.loads, s.set.sheets, s.x).solve(s.d, z);
  for (std::size_t place = 0; place < order.size(); ++place)
    for (int i = 0; i < block; ++i)
      ASSERT_EQ(b[place * static_cast<std::size_t>(block) + static_cast<std::size_t>(i)],
                static_cast<float>(flat(z)[order[place] * block + i]));
}

}  // namespace
}  // namespace condyle
