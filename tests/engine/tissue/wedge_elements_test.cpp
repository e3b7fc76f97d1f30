// The finite elements that the tissue of a face is compared with.
#include "tests/support/wedge_elements.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace condyle::fe {
namespace {

using Eigen::Vector3d;

/// A block of wedges with corners off their regular places.
struct Block {
  Nodes rest;
  std::vector<std::array<int, 6>> wedges;
};

constexpr int cells = 4;
constexpr double young_MPa = 0.02, poisson = 0.45;

Block irregular_block() {
  Block block;
  constexpr int row = cells + 1;
  const auto node = [](int i, int j, int k) { return i + row * (j + row * k); };
  const auto inner = [](int i) { return i > 0 && i < cells; };
  for (int k = 0; k <= cells; ++k)
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) {
        Vector3d p(i, j, k);
        if (inner(i) && inner(j) && inner(k))
          p += 0.15 * Vector3d(std::sin(3.0 * node(i, j, k)), std::sin(5.0 * node(i, j, k)),
                               std::sin(7.0 * node(i, j, k)));
        block.rest.push_back(p);
      }
  for (int k = 0; k < cells; ++k)
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i)
        for (const auto& [a, b, c] :
             {std::array{node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k)},
              {node(i, j, k), node(i + 1, j + 1, k), node(i, j + 1, k)}}) {
          constexpr int above = row * row;
          block.wedges.push_back({a + above, b + above, c + above, a, b, c});
        }
  return block;
}

WedgeBody body_of(const Block& block) {
  return {block.rest, block.wedges,
          std::vector(block.wedges.size(), Material::of(young_MPa, poisson))};
}

Nodes stretched(const Nodes& rest, const Eigen::Matrix3d& by) {
  Nodes x;
  for (const Vector3d& p : rest) x.push_back(by * p);
  return x;
}

TEST(WedgeElements, AUniformStrainHasTheEnergyOfLinearElasticity) {
  const Block block = irregular_block();
  const WedgeBody body = body_of(block);
  EXPECT_NEAR(body.energy(block.rest, nullptr, 1), 0, 1e-15);
  // Uniaxial stress: Young's modulus times half the square of the strain.
  constexpr double strain = 1e-4;
  const Eigen::Matrix3d by =
      Vector3d(1 + strain, 1 - poisson * strain, 1 - poisson * strain).asDiagonal();
  const double volume = std::pow(cells, 3), linear = 0.5 * young_MPa * strain * strain * volume;
  EXPECT_NEAR(body.energy(stretched(block.rest, by), nullptr, 1), linear, 1e-3 * linear);
  // No node inside is pushed.
  Nodes gradient(block.rest.size(), Vector3d::Zero());
  body.energy(stretched(block.rest, by), &gradient, 1);
  const double face_force = young_MPa * strain * cells * cells;
  for (std::size_t i = 0; i < block.rest.size(); ++i)
    if ((block.rest[i].array() > 0.5).all() && (block.rest[i].array() < cells - 0.5).all()) {
      EXPECT_LT(gradient[i].norm(), 1e-6 * face_force);
    }
}

TEST(WedgeElements, ARotationHasNoEnergy) {
  const Block block = irregular_block();
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(1.2, Vector3d(1, 2, 3).normalized()));
  EXPECT_NEAR(body_of(block).energy(stretched(block.rest, turn), nullptr, 1), 0, 1e-13);
}

TEST(WedgeElements, GradientAndCurvatureAreThoseOfTheEnergy) {
  const Block block = irregular_block();
  const WedgeBody body = body_of(block);
  Nodes x = block.rest, d;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = static_cast<double>(i);
    x[i] += 0.1 * Vector3d(std::sin(a), std::sin(2 * a), std::sin(3 * a));
    d.emplace_back(std::sin(4 * a), std::sin(5 * a), std::sin(6 * a));
  }
  constexpr double step = 1e-4;
  const auto at = [&](double t, Nodes* gradient) {
    Nodes moved = x;
    for (std::size_t i = 0; i < x.size(); ++i) moved[i] += t * d[i];
    return body.energy(moved, gradient, 1);
  };
  const auto slope = [&](double t) {
    Nodes gradient(x.size(), Vector3d::Zero());
    at(t, &gradient);
    double sum = 0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += gradient[i].dot(d[i]);
    return sum;
  };
  const double by_energy = (at(step, nullptr) - at(-step, nullptr)) / (2 * step);
  EXPECT_NEAR(slope(0), by_energy, 1e-6 * std::abs(by_energy));
  const double bend = (slope(step) - slope(-step)) / (2 * step);
  EXPECT_NEAR(body.curvature(x, d, 1).exact, bend, 1e-6 * std::abs(bend));
  EXPECT_GT(body.curvature(x, d, 1).gauss_newton, 0);
}

/// With lambda other than a half, a contact of two nodes, an anchor and a force.
TEST(WedgeElements, SlopesOfTheWholeEnergyAreThoseOfItsValue) {
  const Block block = irregular_block();
  const WedgeBody body = body_of(block);
  SpringPrismMesh mesh;
  mesh.node_count = static_cast<int>(block.rest.size());
  mesh.lambda = 0.3;
  mesh.anchor_node = {3};
  mesh.anchor_stiffness = {0.7};
  MeshLoads loads;
  loads.anchor_target = {block.rest[3] + Vector3d(0.2, 0.1, 0)};
  loads.node_force.assign(block.rest.size(), Vector3d(0, 0, -0.01));
  ContactSpring pressed = ContactSpring::of_node(7, Vector3d(0.6, 0, 0.8), 100, 2);
  pressed.node[1] = 8;
  pressed.weight = {0.4, 0.6};
  pressed.count = 2;
  loads.contacts = {pressed, ContactSpring::of_node(9, Vector3d::UnitZ(), -100, 2)};
  WedgeEnergy energy(body, mesh, loads, 2);
  Nodes d, gradient;
  for (std::size_t i = 0; i < block.rest.size(); ++i)
    d.emplace_back(std::sin(4.0 * i), std::sin(5.0 * i), std::sin(6.0 * i));
  constexpr double step = 1e-4;
  const auto moved = [&](double t) {
    Nodes x = block.rest;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += t * d[i];
    return x;
  };
  const auto slope = [&](double t) {
    energy.value_and_gradient(moved(t), gradient);
    double sum = 0;
    for (std::size_t i = 0; i < d.size(); ++i) sum += gradient[i].dot(d[i]);
    return sum;
  };
  const double by_value = (energy.value(moved(step)) - energy.value(moved(-step))) / (2 * step);
  EXPECT_NEAR(slope(0), by_value, 1e-6 * std::abs(by_value));
  const double bend = (slope(step) - slope(-step)) / (2 * step);
  EXPECT_NEAR(energy.curvature(block.rest, d).exact, bend, 1e-6 * std::abs(bend));
}

TEST(WedgeElements, AnElementTurnedInsideOutHasInfiniteEnergy) {
  const Block block = irregular_block();
  Nodes x = block.rest;
  std::swap(x[block.wedges[0][0]], x[block.wedges[0][3]]);
  EXPECT_EQ(body_of(block).energy(x, nullptr, 2), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace condyle::fe
