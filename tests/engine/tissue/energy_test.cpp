// Equation (1), raw and normalised: derivatives, invariance, inversion.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "engine/tissue/hessian_factor.h"
#include "tools/bench/baseline/baseline_minimizers.h"
#include "tools/bench/baseline/synthetic_set.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

enum class Form { normalised, paper };

SyntheticSet small_set(Form form) {
  SyntheticSet set = make_synthetic_set({30, 18, 3, 8, {0, 3}});
  if (form == Form::paper) use_paper_form(set.mesh, {{0.05, 0.03, 0.04}, 0.999});
  return set;
}

struct Random {
  std::mt19937 engine;
  double operator()() { return std::uniform_real_distribution<double>(-1, 1)(engine); }
  Vector3d vector() { return {(*this)(), (*this)(), (*this)()}; }
  Pose pose() {
    Pose pose;
    pose.R = Eigen::Quaterniond((*this)(), (*this)(), (*this)(), (*this)()).normalized();
    pose.t = 100 * vector();
    return pose;
  }
};

class EachForm : public testing::TestWithParam<Form> {};

/// Over magnitudes of displacement, at random positions and orientations: a smooth stretch of that
/// magnitude, perturbed as far as prisms permit.
TEST_P(EachForm, DerivativesEqualCentralDifferencesFromAMillionthToAThousandMillimetres) {
  SyntheticSet set = small_set(GetParam());
  Random random{std::mt19937(5)};
  for (double magnitude = 1e-6; magnitude < 2e3; magnitude *= 10) {
    const Pose pose = random.pose();
    MeshLoads loads = synthetic_loads(set, Pose{});
    Nodes x = set.rest;
    for (auto& p : x) {
      const double stretch = magnitude / 60;
      p += stretch * Vector3d(p.x() + 0.2 * p.z(), 0.7 * p.y(), 0.5 * p.z());
      p += std::min(0.5 * magnitude, 0.6) * random.vector();
      p = pose * p;
    }
    for (auto& p : loads.anchor_target) p = pose * p;
    loads.node_force.assign(x.size(), Vector3d(0.01, -0.02, 0.03));
    // Two pressed and one free, by about the magnitude: a node, and points of triangles.
    const double depth[] = {1, -1, 2};
    const std::array<ContactSpring, 3> shapes = {{{{3}, {1}, 1},
                                                  {{7, 11, 15}, {0.2, 0.3, 0.5}, 3},
                                                  {{30, 34, 2, 6}, {0.4, 0.6, -0.5, -0.5}, 4}}};
    for (int i = 0; i < 3; ++i) {
      ContactSpring row = shapes[i];
      row.normal = random.vector().normalized();
      row.offset = row.along(x) + depth[i] * magnitude;
      row.stiffness = 0.5;
      loads.contacts.push_back(row);
    }
    loads.anchor_scale.assign(set.mesh.anchor_node.size(), 0.3);
    // Muscles in each part of their law: through tissue and from a fixed place, and a loop.
    const MuscleLine::Point first{{5, 9, 13}, {0.3, 0.3, 0.4}}, middle{{40, 44}, {0.5, 0.5}},
        last{{60, 64}, {0.25, 0.75}};
    for (const double fraction : {1.1, 0.9, 0.5}) {
      for (MuscleLine muscle : {MuscleLine{{first, middle, last}}, MuscleLine{{{}, middle, last}},
                                MuscleLine{{first, middle, last, first}}}) {
        if (muscle.points[0].node.empty()) muscle.points[0].fixed = 1.5 * x[5] + x[61];
        const double length = muscle.length(x);
        muscle.shortest = fraction * length;
        muscle.stiffness = 0.7;
        muscle.limit = muscle.stiffness * 0.3 * length;
        loads.muscles.push_back(muscle);
      }
    }
    SpringPrismEnergy energy(set.mesh, loads, 1);
    Nodes g, up = x, down = x, g_up, g_down, d(x.size());
    ASSERT_TRUE(std::isfinite(energy.value_and_gradient(x, g))) << magnitude;
    EXPECT_EQ(energy.value(x), energy.value_and_gradient(x, g));
    double size = 0;
    for (const auto& v : g) size += v.squaredNorm();
    for (std::size_t i = 0; i < x.size(); ++i)
      d[i] = g[i] / std::sqrt(size) + 0.2 * random.vector() / std::sqrt(3.0 * x.size());
    const double h = 1e-3 * std::min(magnitude, 1.0);
    for (std::size_t i = 0; i < x.size(); ++i) {
      up[i] += h * d[i];
      down[i] -= h * d[i];
    }
    const double difference =
        (energy.value_and_gradient(up, g_up) - energy.value_and_gradient(down, g_down)) / (2 * h);
    energy.value_and_gradient(x, g);
    double slope = 0, bend = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      slope += g[i].dot(d[i]);
      bend += d[i].dot(g_up[i] - g_down[i]) / (2 * h);
    }
    EXPECT_GT(slope, 1e-12);
    EXPECT_NEAR(slope, difference, 2e-4 * slope) << magnitude;
    const auto curvature = energy.curvature(x, d);
    EXPECT_GT(curvature.gauss_newton, 0);
    EXPECT_NEAR(curvature.exact, bend, 1e-3 * curvature.gauss_newton) << magnitude;
  }
}

TEST_P(EachForm, DoesNotChangeUnderRigidMotion) {
  const SyntheticSet set = small_set(GetParam());
  Random random{std::mt19937(8)};
  MeshLoads loads = synthetic_loads(set, synthetic_pose(0.1, {1, 0, 0}));
  Nodes x = set.rest, g, turned_g;
  for (auto& p : x) p += 0.8 * random.vector();
  const double before = SpringPrismEnergy(set.mesh, loads, 1).value_and_gradient(x, g);
  for (int i = 0; i < 5; ++i) {
    const Pose pose = random.pose();
    Nodes turned = x;
    MeshLoads turned_loads = loads;
    for (auto& p : turned) p = pose * p;
    for (auto& p : turned_loads.anchor_target) p = pose * p;
    const double after =
        SpringPrismEnergy(set.mesh, turned_loads, 1).value_and_gradient(turned, turned_g);
    EXPECT_GT(before, 0.1);
    EXPECT_NEAR(after, before, 1e-10 * before);
    for (std::size_t k = 0; k < g.size(); ++k)
      EXPECT_LT((pose.R * g[k] - turned_g[k]).norm(), 1e-8 * (1 + g[k].norm()));
  }
}

TEST_P(EachForm, IsEquationOneAtRestPlusAPulledNode) {
  const SyntheticSet set = small_set(GetParam());
  const SpringPrismMesh& mesh = set.mesh;
  Nodes x = set.rest;
  x[20] += Vector3d(0.3, -0.2, 0.4);
  double springs = 0, volumes = 0;
  for (std::size_t s = 0; s < mesh.spring_a.size(); ++s) {
    const double stretch = (x[mesh.spring_a[s]] - x[mesh.spring_b[s]]).norm() - mesh.rest_length[s];
    springs += mesh.stiffness[s] * (stretch < 0 ? mesh.compression_ratio : 1) * stretch * stretch;
  }
  for (std::size_t p = 0; p < mesh.prisms.size(); ++p)
    volumes +=
        mesh.volume_weight[p] * std::pow(prism_volume(x, mesh.prisms[p]) - mesh.rest_volume[p], 2);
  for (std::size_t i = 0; i < mesh.anchor_node.size(); ++i)
    if (mesh.anchor_node[i] == 20) springs += mesh.anchor_stiffness[i] * 0.29;
  const MeshLoads loads = synthetic_loads(set, Pose{});
  const double expected = mesh.lambda * springs + (1 - mesh.lambda) * volumes;
  EXPECT_GT(volumes, 0);
  EXPECT_NEAR(SpringPrismEnergy(mesh, loads, 1).value(x), expected, 1e-10 * expected);
  if (GetParam() == Form::paper) {
    EXPECT_EQ(mesh.volume_weight[0], 1);
    EXPECT_EQ(mesh.compression_ratio, 1);
  }
}

/// The lower bone is driven 30 mm into the tissue: whatever the method and form, no prism inverts.
TEST_P(EachForm, NoMethodInvertsAPrism) {
  SyntheticSet set = small_set(GetParam());
  if (GetParam() == Form::paper) set.mesh.lambda = 0.999999;  // volumes that hardly resist
  const MeshLoads loads = synthetic_loads(set, synthetic_pose(0, {0, -30, 12}));
  const HessianFactor factor(set.mesh, synthetic_loads(set, Pose{}), set.sheets, set.rest);
  SpringPrismEnergy energy(set.mesh, loads, 1);
  for (const auto& method : all_methods()) {
    Nodes x = set.rest;
    MinimizeSettings settings;
    settings.max_iterations = method.method == Method::powell ? 5 : 300;
    const double before = energy.value(x);
    const auto result = minimize_with(method.method, energy, settings, x, &factor);
    EXPECT_LT(result.energy, 0.9 * before) << method.name;
    double least = 1e9;
    for (std::size_t p = 0; p < set.mesh.prisms.size(); ++p)
      least = std::min(least, prism_volume(x, set.mesh.prisms[p]) / set.mesh.rest_volume[p]);
    EXPECT_GT(least, 0) << method.name;
    EXPECT_LT(least, 0.9) << method.name;  // it was pressed indeed
  }
}

INSTANTIATE_TEST_SUITE_P(Energy, EachForm, testing::Values(Form::normalised, Form::paper));

TEST(Energy, TheBarrierGrowsWithoutBoundAsAPrismFlattens) {
  SpringPrismMesh mesh;
  mesh.node_count = 6;
  mesh.prisms = {{0, 1, 2, 3, 4, 5}};
  Nodes x{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.rest_volume = {prism_volume(x, mesh.prisms[0])};
  mesh.volume_weight = {1};
  const MeshLoads loads;
  SpringPrismEnergy energy(mesh, loads, 1);
  double before = energy.value(x);
  for (double height : {0.5, 0.2, 0.05, 0.01, 0.002}) {
    for (int i = 0; i < 3; ++i) x[i].z() = height;
    const double now = energy.value(x);
    EXPECT_GT(now, before);
    before = now;
  }
  EXPECT_GT(before, 50 * 0.5 * 0.25);  // far above the plain (v - v0)^2
  for (double height : {0.0, -0.3}) {
    for (int i = 0; i < 3; ++i) x[i].z() = height;
    EXPECT_TRUE(std::isinf(energy.value(x)));
  }
}

}  // namespace
}  // namespace condyle
