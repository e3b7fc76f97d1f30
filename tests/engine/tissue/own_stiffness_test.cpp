// Contact is limited to a multiple of what its tissue resists.
#include "engine/tissue/own_stiffness.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "engine/tissue/layered_mesh.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(OwnStiffness, IsTheHarmonicMeanOfTheEnergysSecondDerivatives) {
  // Two triangles of columns with random heights: stiff across, soft along.
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> shift(-0.3, 0.3);
  constexpr int sheets = 3;
  Nodes rest;
  for (const auto& corner :
       {Vector3d(0, 0, 0), Vector3d(4, 0, 0), Vector3d(4, 5, 0), Vector3d(0, 5, 0)})
    for (int s = 0; s < sheets; ++s)
      rest.push_back(corner + Vector3d(shift(random), shift(random), -2 * s + shift(random)));
  SpringPrismMesh mesh =
      layered_mesh({{0, 1, 2}, {0, 2, 3}}, sheets, rest, std::vector<LayerMaterial>(sheets - 1));
  mesh.compression_ratio = 1;  // otherwise there are two second derivatives at rest
  const MeshLoads none;
  SpringPrismEnergy energy(mesh, none, 1);
  const std::vector<double> own = own_stiffness(mesh, rest);
  ASSERT_EQ(own.size(), rest.size());
  for (std::size_t node = 0; node < rest.size(); ++node) {
    constexpr double step = 1e-5;
    Matrix3d second;
    for (int k = 0; k < 3; ++k) {
      Nodes x = rest, plus, minus;
      x[node][k] += step;
      energy.value_and_gradient(x, plus);
      x[node][k] -= 2 * step;
      energy.value_and_gradient(x, minus);
      second.col(k) = (plus[node] - minus[node]) / (2 * step);
    }
    const double mean = 3 / second.inverse().trace() / (2 * mesh.lambda);
    EXPECT_NEAR(own[node], mean, 1e-4 * mean);
  }
}

TEST(OwnStiffness, LimitsContactOfSoftTissueAlone) {
  const std::vector<double> own = {0.01, 2, 1};
  std::vector<PointContact> contacts(3);
  const Vector3d up = Vector3d::UnitZ();
  contacts[0].spring = ContactSpring::of_node(0, up, 0, 3);
  contacts[1].spring = ContactSpring::of_node(1, up, 0, 3);
  contacts[2].spring = {{1, 2}, {1, -1}, 2, up, 0, 10};  // two surfaces: springs in series
  limit_stiffness(own, 6, contacts);
  EXPECT_DOUBLE_EQ(contacts[0].spring.stiffness, 0.06);
  EXPECT_DOUBLE_EQ(contacts[1].spring.stiffness, 3);
  EXPECT_DOUBLE_EQ(contacts[2].spring.stiffness, 4);
}

}  // namespace
}  // namespace condyle
