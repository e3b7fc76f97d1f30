// Tissue of springs and prisms against bodies whose answer is known in closed form: a modulus and
// a Poisson's ratio are asked for, and must come out at any shape of the mesh's cells.
#include <gtest/gtest.h>

#include "tests/engine/tissue/elastic_block.h"
#include "tests/support/wedge_elements.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr LayerMaterial soft{0.02, 0.45, 0}, softer{0.02, 0.3, 0};
constexpr double symmetric = 1;  // springs push as they pull: the energy of an elastic body

/// Mean displacement of the nodes at one coordinate along an axis of the box, in the box's frame.
Vector3d mean_moved(const ElasticBlock& block, const Settled& settled, int axis, double at) {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  block.each_node([&](int node, const Vector3d& place) {
    if (std::abs(place[axis] - at) > 1e-9) return;
    sum += settled.nodes[node] - place.cwiseProduct(block.size.mm());
    ++count;
  });
  return sum / count;
}

struct BarCase {
  const char* name;
  BoxSize size;
  int axis;  // along which it is long and pulled
};
std::ostream& operator<<(std::ostream& out, const BarCase& bar) { return out << bar.name; }

class Bar : public testing::TestWithParam<BarCase> {};

struct BarAnswer {
  double strain, narrowing;  // along; across over along
};

/// Both ends pulled by `force_N`, evenly distributed; minimal supports otherwise.
BarAnswer pull(const BarCase& bar, const LayerMaterial& material, double fraction, double force_N) {
  ElasticBlock block = make_block(bar.size, material, fraction);
  MeshLoads loads;
  const int a = bar.axis, b = (a + 1) % 3, c = (a + 2) % 3;
  loads.node_force.assign(block.rest.size(), Vector3d::Zero());
  // A node's part of an end: its part of the triangles there, or of the rows and layers.
  std::vector<double> area(block.place.size(), 0.0);
  double whole = 0;
  for (const auto& t : block.triangles) {
    const Eigen::Vector2d u = block.place[t[1]] - block.place[t[0]];
    const Eigen::Vector2d v = block.place[t[2]] - block.place[t[0]];
    const double twice = std::abs(u.x() * v.y() - u.y() * v.x());
    whole += twice;
    for (int k = 0; k < 3; ++k) area[t[k]] += twice / 3;
  }
  block.each_node([&](int node, const Vector3d& at) {
    if (at[a] > 0 && at[a] < 1) return;
    double part = 1.0 / (bar.size.rows * bar.size.layers);
    for (int k : {b, c})
      if (at[k] == 0 || at[k] == 1) part *= 0.5;
    if (a == 2) part = area[node / (bar.size.layers + 1)] / whole;
    loads.node_force[node] =
        (block.pose.R * Vector3d::Unit(a)) * ((at[a] > 0 ? 1 : -1) * force_N * part);
  });
  for (std::size_t i = 0; i < block.rest.size(); ++i)
    hold(block, loads, static_cast<int>(i), block.rest[i], 1e-6);
  const Settled settled = settle(block, loads);
  EXPECT_TRUE(settled.converged);
  const double length = bar.size.mm()[a];
  BarAnswer answer;
  answer.strain =
      (mean_moved(block, settled, a, 0.75)[a] - mean_moved(block, settled, a, 0.25)[a]) /
      (0.5 * length);
  double narrow = 0;
  for (int k : {b, c}) {  // of the middle's sides
    double sides[2] = {0, 0};
    int counts[2] = {0, 0};
    block.each_node([&](int node, const Vector3d& at) {
      if (std::abs(at[a] - 0.5) > 0.26 || (at[k] != 0 && at[k] != 1)) return;
      sides[at[k] == 1] += settled.nodes[node][k];
      ++counts[at[k] == 1];
    });
    const double width = bar.size.mm()[k];
    narrow += 0.5 * (width - (sides[1] / counts[1] - sides[0] / counts[0])) / width;
  }
  answer.narrowing = narrow / answer.strain;
  return answer;
}

TEST_P(Bar, StretchesByForceOverModulusAndSectionAndNarrowsByPoissonsRatio) {
  const BarCase& bar = GetParam();
  const double section = bar.size.mm().prod() / bar.size.mm()[bar.axis];
  for (const LayerMaterial& material : {soft, softer})
    for (double strain : {0.01, -0.001}) {
      const auto got = pull(bar, material, symmetric, strain * material.modulus_MPa * section);
      EXPECT_NEAR(got.strain / strain, 1, 0.08);  // half triangles end each second row
      EXPECT_NEAR(got.narrowing / material.poisson, 1, 0.12);
    }
}

/// Springs that are weak when shortened, as tissue's are by default: a bar is stiffer in tension,
/// by up to a third, and softer in compression, by up to a half.
TEST_P(Bar, ThatBucklesIsStifferPulledAndSofterPressed) {
  const BarCase& bar = GetParam();
  const double section = bar.size.mm().prod() / bar.size.mm()[bar.axis];
  const auto stretched = [&](double strain) {
    return pull(bar, soft, 0.05, strain * soft.modulus_MPa * section).strain / strain;
  };
  EXPECT_NEAR(stretched(0.01), 0.85, 0.15);
  EXPECT_NEAR(stretched(-0.001), 1.75, 0.5);
}

INSTANTIATE_TEST_SUITE_P(ClosedForm, Bar,
                         testing::Values(BarCase{"sheets", {20, 6, 3, 3, 3}, 0},
                                         BarCase{"thinner layers", {20, 6, 5, 4, 2.8}, 0},
                                         BarCase{"across layers", {7, 8, 16, 2, 2}, 2}));

struct ShearCase {
  const char* name;
  int along, across;
  BoxSize size;
};
std::ostream& operator<<(std::ostream& out, const ShearCase& shear) { return out << shear.name; }

class Shear : public testing::TestWithParam<ShearCase> {};

/// The border is sheared; the interior follows, and stores mu gamma^2 / 2 in each mm^3.
TEST_P(Shear, StoresTheEnergyOfAnElasticBlockAndStaysEven) {
  constexpr double gamma = 0.04;
  const ShearCase& shear = GetParam();
  for (const LayerMaterial& material : {soft, softer})
    for (double fraction : {symmetric, 0.05}) {
      ElasticBlock block = make_block(shear.size, material, fraction);
      MeshLoads loads;
      const auto sheared = [&](const Vector3d& place) {
        Vector3d p = place.cwiseProduct(shear.size.mm());
        p[shear.along] += gamma * p[shear.across];
        return p;
      };
      block.each_node([&](int node, const Vector3d& at) {
        if (at.minCoeff() == 0 || at.maxCoeff() == 1)
          hold(block, loads, node, block.pose * sheared(at), 100);
      });
      const Settled settled = settle(block, loads);
      EXPECT_TRUE(settled.converged);
      const double mu = material.modulus_MPa / (2 * (1 + material.poisson));
      const double expected = 0.5 * mu * gamma * gamma * shear.size.mm().prod();
      double most = 0;
      int inner = 0;
      block.each_node([&](int node, const Vector3d& at) {
        most = std::max(most, (settled.nodes[node] - sheared(at)).norm());
        inner += at.minCoeff() > 0 && at.maxCoeff() < 1;
      });
      EXPECT_GT(inner, 20);
      EXPECT_NEAR(settled.energy / expected, 1, 0.06);
      EXPECT_LT(most, 0.05 * gamma * shear.size.mm()[shear.across]);
    }
}

INSTANTIATE_TEST_SUITE_P(ClosedForm, Shear,
                         testing::Values(ShearCase{"across", 0, 2, {8, 10, 5, 3, 3}},
                                         ShearCase{"along", 0, 1, {8, 10, 5, 3, 3}},
                                         ShearCase{"tall cells", 1, 2, {8, 10, 4, 2, 3}}));

/// Suspended by an end, a bar of density rho lengthens by rho g L^2 / (2 E).
TEST(ClosedForm, ABarHangsDownByItsWeight) {
  const BoxSize size{24, 6, 3, 3, 3};
  LayerMaterial material = soft;
  material.mass_kg = 1e-6 * size.mm().prod() / size.layers;  // per layer, of water
  ElasticBlock block = make_block(size, material, symmetric);
  MeshLoads loads;
  loads.node_force = weight_of_nodes(block.mesh, (block.pose.R * Vector3d::UnitX()));
  block.each_node([&](int node, const Vector3d& at) {
    if (at.x() == 0) hold(block, loads, node, block.rest[node], 100);
  });
  const Settled settled = settle(block, loads);
  EXPECT_TRUE(settled.converged);
  for (double at : {0.5, 1.0}) {
    const double expected = 1e-6 * 9.81 * 72 * 72 * (at - 0.5 * at * at) / soft.modulus_MPa;
    const double got = mean_moved(block, settled, 0, at).x();
    EXPECT_NEAR(got / expected, 1, 0.06);
    EXPECT_GT(expected, 0.5);
  }
}

/// The same for the finite elements that faces are compared with.
TEST(ClosedForm, ABarOfFiniteElementsHangsDownByItsWeight) {
  const BoxSize size{24, 6, 3, 3, 3};
  LayerMaterial material = soft;
  material.mass_kg = 1e-6 * size.mm().prod() / size.layers;
  ElasticBlock block = make_block(size, material, symmetric);
  MeshLoads loads;
  loads.node_force = weight_of_nodes(block.mesh, (block.pose.R * Vector3d::UnitX()));
  block.each_node([&](int node, const Vector3d& at) {
    if (at.x() == 0) hold(block, loads, node, block.rest[node], 100);
  });
  const fe::WedgeBody body(
      block.rest, block.mesh.prisms,
      std::vector(block.mesh.prisms.size(), fe::Material::of(soft.modulus_MPa, soft.poisson)));
  fe::WedgeEnergy energy(body, block.mesh, loads, 1);
  MinimizeSettings settings;
  settings.tolerance_mm = 1e-5;
  Settled settled{block.rest, 0, false};
  settled.converged =
      minimize(energy, HessianFactor(block.mesh, loads, 1, block.rest), settings, settled.nodes)
          .converged();
  EXPECT_TRUE(settled.converged);
  for (Vector3d& p : settled.nodes) p = block.pose.inverse() * p;
  const double expected = 1e-6 * 9.81 * 72 * 72 * 0.5 / soft.modulus_MPa;
  EXPECT_NEAR(mean_moved(block, settled, 0, 1).x() / expected, 1, 0.03);
}

}  // namespace
}  // namespace condyle
