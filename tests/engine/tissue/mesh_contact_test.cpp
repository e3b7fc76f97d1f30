// A mesh slides on bodies and on itself, and enters neither.
#include "engine/tissue/mesh_contact.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <utility>

#include "engine/mesh/measure.h"
#include "engine/minimize/minimize.h"
#include "engine/tissue/hessian_factor.h"
#include "engine/tissue/layered_mesh.h"
#include "engine/tissue/refactorization.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// A flat slab of n x n columns, 3 mm apart; sheet 0 faces up.
struct HeldSlab {
  static constexpr int sheets = 3;
  std::vector<Eigen::Vector3i> triangles;
  Nodes rest;
  SpringPrismMesh mesh;
  std::vector<MeshPoint> below;  // points of the lowest sheet

  explicit HeldSlab(int n, const Vector3d& corner) {
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        for (int s = 0; s < sheets; ++s) rest.push_back(corner + Vector3d(3 * i, 3 * j, -3 * s));
    for (int j = 0; j + 1 < n; ++j)
      for (int i = 0; i + 1 < n; ++i) {
        const int a = j * n + i;
        triangles.emplace_back(a, a + 1, a + n + 1);
        triangles.emplace_back(a, a + n + 1, a + n);
      }
    mesh = layered_mesh(triangles, sheets, rest, std::vector<LayerMaterial>(sheets - 1));
    for (int c = 0; c < n * n; ++c) below.push_back(MeshPoint::of_node(lowest(c)));
    for (const auto& t : triangles)
      below.push_back(MeshPoint::centre(lowest(t[0]), lowest(t[1]), lowest(t[2])));
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        if (i == 0 || j == 0 || i + 1 == n || j + 1 == n)
          for (int s = 0; s < sheets; ++s) {
            mesh.anchor_node.push_back(node_of(j * n + i, s, sheets));
            mesh.anchor_stiffness.push_back(1.0);
          }
  }
  static int lowest(int column) { return node_of(column, sheets - 1, sheets); }
  MeshLoads held_at(const Vector3d& moved) const {
    MeshLoads loads;
    for (int node : mesh.anchor_node) loads.anchor_target.push_back(rest[node] + moved);
    return loads;
  }
};

Box wide_box() {
  Box box;
  box.add(Vector3d::Constant(-60));
  box.add(Vector3d::Constant(60));
  return box;
}

/// Deepest point inside a closed mesh, mm: by winding number and nearest triangle, which the
/// contact itself does not use.
double deepest(const TriMesh& body, const std::vector<MeshPoint>& points, const Nodes& x) {
  const TriangleTree tree(body);
  double depth = 0;
  for (const auto& point : points)
    if (tree.winding_number(point.at(x)) > 0.5)
      depth = std::max(depth, tree.nearest(point.at(x)).distance);
  return depth;
}

/// A factor made before any contact lacks the contact rows: along those directions it is wrong by
/// contact's stiffness over the tissue's, and with it alone a draped slab takes about 500
/// iterations, ten times as many as with one that is refactored during the solve.
ContactSolveResult settle(const SpringPrismMesh& mesh, int sheets, MeshLoads& loads,
                          const std::function<ContactLists(const Nodes&)>& look, Nodes& x,
                          double tolerance_mm = 1e-4) {
  return solve_contact(look,
                       [&](bool) {
                         const HessianFactor factor(mesh, loads, sheets, x);
                         SpringPrismEnergy energy(mesh, loads, 1);
                         const auto result = minimize_with_refactorization(
                             mesh, loads, energy, factor, {.tolerance_mm = tolerance_mm}, x);
                         EXPECT_TRUE(result.converged());
                         return Solved::at_minimum;
                       },
                       loads, x,
                       {.max_contact_searches = 12, .tolerance_mm = 1e-3, .gap_mm = 0.02});
}

// Without friction a point would come to rest wherever the direction is discontinuous.
TEST(MeshContact, NormalOfAnObstacleVariesContinuouslyAlongItsSurface) {
  constexpr double radius = 15, step_mm = 0.01;
  const ContactObstacle ball(test::sphere(3, radius), wide_box(), {});
  std::mt19937_64 random(9);
  double most = 0, whole = 0;
  for (int run = 0; run < 20; ++run) {
    const Eigen::Matrix3d turn = test::any_pose(random, 0).R.toRotationMatrix();
    Vector3d before = Vector3d::Zero();
    for (int i = 0; i < 1000; ++i) {
      const double angle = i * step_mm / radius;
      const Vector3d out = turn * Vector3d(std::cos(angle), std::sin(angle), 0);
      ContactObstacle::Near near;
      ASSERT_TRUE(ball.near(radius * out, 1.5, near));
      if (i > 0) most = std::max(most, (near.normal - before).norm());
      if (i > 0) whole += (near.normal - before).norm() / 20;
      before = near.normal;
    }
  }
  EXPECT_GT(whole, 0.5);                   // it goes around by 0.67
  EXPECT_LT(most, 10 * step_mm / radius);  // facets meet at angles of 0.1 and more
}

/// A roof of a sharp ridge along x, turned.
TriMesh turned_roof(const Eigen::Matrix3d& turn) {
  TriMesh mesh;
  for (double x : {-10.0, 10.0})
    for (const auto& [y, z] : {std::pair{-6.0, -12.0}, {6.0, -12.0}, {0.0, 0.0}})
      mesh.vertices.emplace_back(turn * Vector3d(x, y, z));
  mesh.triangles = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                    {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  return mesh;
}

// Where it jumped, contact at an edge had no equilibrium and the solution went to and fro.
TEST(MeshContact, DistanceVariesContinuouslyAboutASharpEdge) {
  constexpr double step_mm = 0.002;
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> uniform(-1, 1);
  double most = 0;
  int inside = 0;
  for (int roof = 0; roof < 6; ++roof) {
    const Eigen::Matrix3d turn = test::any_pose(random, 0).R.toRotationMatrix();
    const ContactObstacle ridge(turned_roof(turn), wide_box(), {});
    for (int run = 0; run < 40; ++run) {  // past the ridge, above and below it
      const Vector3d middle(5 * uniform(random), 0, 0.8 * uniform(random));
      const Vector3d along = Vector3d(uniform(random), 1, uniform(random)).normalized();
      double before = 0;
      for (int i = -500; i <= 500; ++i) {
        ContactObstacle::Near near;
        ASSERT_TRUE(ridge.near(turn * (middle + i * step_mm * along), 1.9, near));
        if (i > -500) most = std::max(most, std::abs(near.distance - before));
        inside += near.distance < 0;
        before = near.distance;
      }
    }
  }
  EXPECT_GT(inside, 10000);
  EXPECT_LT(most, 2 * step_mm);
}

TEST(MeshContact, ObstacleReportsTheDistanceOfABallAtAnyPose) {
  std::mt19937_64 random(4);
  const double radius = 15;
  const ContactObstacle ball(test::sphere(5, radius), wide_box(), {});
  const Pose pose = test::any_pose(random, 30);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int near = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d direction = Vector3d(uniform(random), uniform(random), uniform(random));
    const double distance = 6 * uniform(random);
    const MeshPoint point = MeshPoint::of_node(0);
    const Nodes x = {pose * Vector3d(direction.normalized() * (radius + distance))};
    std::vector<PointContact> contacts;
    find_obstacle_contacts({point}, {0.0}, ball, pose, x, {}, contacts);
    if (distance > 1.55) {
      EXPECT_TRUE(contacts.empty()) << distance;
      continue;
    }
    if (distance > 1.45) continue;
    ++near;
    ASSERT_EQ(contacts.size(), 1u) << distance;
    EXPECT_NEAR(contacts[0].gap, distance, 0.02);
    EXPECT_NEAR(contacts[0].spring.gap(x), contacts[0].gap, 1e-12);
    EXPECT_GT(contacts[0].spring.normal.dot(pose.R * direction.normalized()), 0.995);
  }
  EXPECT_GT(near, 800);
}

// The rim of a slab is pulled past a ball: its lower side rests on the ball, and slides there.
TEST(MeshContact, CachedPointDistancesChangeNoResult) {
  const ContactObstacle ball(test::sphere(4, 20), wide_box(), {});
  const HeldSlab slab(15, {-21, -21, 26});
  const std::vector<double> allowance(slab.below.size(), 0.0);
  std::mt19937 random{11};
  std::uniform_real_distribution<double> some{-1, 1};
  const auto vector = [&] { return Vector3d(some(random), some(random), some(random)); };
  Nodes x = slab.rest;
  Pose X_WO;
  NearPoints known;
  NearPoints counted;
  int queried = 0, touched = 0;
  for (int look = 0; look < 200; ++look) {
    // Both move about each other at random, sometimes far in one step.
    const double scale = look % 20 == 0 ? 2 : 0.1;
    X_WO =
        Pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.02 * scale * some(random), Vector3d::UnitX())),
             scale * vector()} *
        X_WO;
    X_WO.t *= 0.97;
    for (auto& p : x) p += 0.2 * scale * vector();
    std::vector<PointContact> with, without;
    find_obstacle_contacts(slab.below, allowance, ball, X_WO, x, {}, with, {}, &known);
    find_obstacle_contacts(slab.below, allowance, ball, X_WO, x, {}, without);
    Nodes seen;
    for (const auto& p : x) seen.push_back(X_WO.inverse() * p);
    counted.moved(slab.below, seen);
    counted.each(1.5, [&](int i) {
      ++queried;
      ContactObstacle::Near near;
      ball.near(slab.below[static_cast<std::size_t>(i)].at(seen), 1.5, near);
      return near.distance;
    });
    touched += !without.empty();
    ASSERT_EQ(with.size(), without.size()) << look;
    for (std::size_t i = 0; i < with.size(); ++i) {
      EXPECT_EQ(with[i].point, without[i].point);
      EXPECT_EQ(with[i].gap, without[i].gap);
    }
  }
  EXPECT_LT(queried, 0.5 * 200 * static_cast<double>(slab.below.size()));  // most are passed over
  EXPECT_GT(touched, 100);
}

TEST(MeshContact, ASlabDrapesOverABallItDoesNotEnter) {
  const TriMesh mesh = test::sphere(5, 15);
  const ContactObstacle ball(mesh, wide_box(), {});
  const HeldSlab slab(15, Vector3d(-21, -21, 22));  // lowest sheet at 16 mm
  const std::vector<double> none(slab.below.size(), 0.0);
  const auto look = [&](const Nodes& x) {
    ContactLists lists(1);
    find_obstacle_contacts(slab.below, none, ball, Pose{}, x, {.stiffness = 0.1}, lists[0]);
    return lists;
  };
  MeshLoads loads = slab.held_at({2, 0, -8});
  Nodes x = slab.rest, through = slab.rest;
  settle(
      slab.mesh, HeldSlab::sheets, loads, [](const Nodes&) { return ContactLists(1); }, through);
  EXPECT_GT(deepest(mesh, slab.below, through), 3);  // otherwise it would go deep
  const auto result = settle(slab.mesh, HeldSlab::sheets, loads, look, x);
  EXPECT_LE(result.error_mm, 1e-3);
  EXPECT_LT(deepest(mesh, slab.below, x), 0.2);

  // What presses lies on the ball itself, and its forces balance the mesh's.
  MeshLoads bare = loads;
  bare.contacts.clear();
  Nodes force;
  SpringPrismEnergy(slab.mesh, bare, 1).value_and_gradient(x, force);
  int pressed = 0;
  double most = 0;
  for (const auto& contact : result.contacts[0]) {
    if (contact.push == 0) continue;
    ++pressed;
    EXPECT_LT(std::abs(contact.gap), 0.02);
    const double press = 2 * slab.mesh.lambda * contact.spring.stiffness * contact.push;
    most = std::max(most, press);
    for (int i = 0; i < contact.spring.count; ++i)
      force[contact.spring.node[i]] -= press * contact.spring.weight[i] * contact.spring.normal;
  }
  for (const auto& f : force) EXPECT_LT(f.norm(), 0.02 * most);
  EXPECT_GT(pressed, 10);
}

TEST(MeshContact, TheSolverLearnsWhetherContactsAreSettled) {
  const ContactObstacle ball(test::sphere(5, 15), wide_box(), {});
  const double heights[] = {15.2, 14, 17, 17};  // of the node after each call
  Nodes x = {Vector3d(0, 0, 15.2)};
  std::vector<bool> settled;
  MeshLoads loads;
  solve_contact(
      [&](const Nodes& at) {
        ContactLists lists(1);
        find_obstacle_contacts({MeshPoint::of_node(0)}, {0.0}, ball, Pose{}, at, {}, lists[0]);
        return lists;
      },
      [&](bool contacts_settled) {
        x[0].z() = heights[settled.size()];
        settled.push_back(contacts_settled);
        return settled.size() < std::size(heights) ? Solved::in_progress : Solved::at_minimum;
      },
      loads, x, {.max_contact_searches = 4});
  // Before any solve nothing is known; 1 mm inside the ball the node is too far from its surface.
  EXPECT_EQ(settled, (std::vector<bool>{false, true, false, true}));
}

// A node on a spring is drawn 1 mm into a surface whose gap changes four times as fast as its
// plane.
TEST(MeshContact, GapsSteeperThanTheirPlanesConverge) {
  constexpr double steep = 4, stiffness = 3;
  Nodes x = {Vector3d::Zero()};
  MeshLoads loads;
  const auto look = [&](const Nodes& at) {
    PointContact contact;
    contact.gap = steep * at[0].z();
    contact.spring.node[0] = 0;
    contact.spring.weight[0] = 1;
    contact.spring.count = 1;
    contact.spring.normal = Vector3d::UnitZ();
    contact.spring.stiffness = stiffness;
    contact.spring.offset = contact.spring.along(at) - contact.gap;
    contact.at = at[0];
    return ContactLists{{contact}};
  };
  const auto minimize_exactly = [&](bool) {
    const double offset = loads.contacts[0].offset;
    const double pressed = (stiffness * offset - 1) / (stiffness + 1);
    x[0].z() = pressed < offset ? pressed : -1;
    return Solved::at_minimum;
  };
  const auto result = solve_contact(look, minimize_exactly, loads, x, {.max_contact_searches = 40});
  std::printf("settled after %d searches, gap %.3f mm\n", result.solves, result.gap_mm);
  EXPECT_TRUE(result.settled);
  EXPECT_LT(std::abs(steep * x[0].z()), 0.03);
  EXPECT_NEAR(stiffness * result.contacts[0][0].push, 1, 0.1);
}

TEST(MeshContact, StifferContactStartsFromTheForcesOfTheSofter) {
  const ContactObstacle ball(test::sphere(5, 15), wide_box(), {});
  const Nodes x = {Vector3d(0, 0, 14.8), Vector3d(15.1, 0, 0)};
  const std::vector<MeshPoint> points = {MeshPoint::of_node(0), MeshPoint::of_node(1)};
  const auto look = [&](double stiffness) {
    std::vector<PointContact> contacts;
    find_obstacle_contacts(points, {0.0, 0.0}, ball, Pose{}, x, {.stiffness = stiffness}, contacts);
    return contacts;
  };
  std::vector<PointContact> before = look(1);
  ASSERT_EQ(before.size(), 2u);
  before[0].push = 0.5;
  const auto firm = with_history(before, look(8), x);
  ASSERT_EQ(firm.size(), 2u);
  EXPECT_NEAR(8 * firm[0].push, before[0].pressed(x), 1e-9);
  EXPECT_GT(before[0].pressed(x), 0.6);
  EXPECT_EQ(firm[1].push, 0);
}

TEST(MeshContact, OverlapAtRestMayRemainButNotDeepen) {
  const TriMesh mesh = test::sphere(5, 15);
  const ContactObstacle ball(mesh, wide_box(), {});
  const HeldSlab slab(15, Vector3d(-21, -21, 19.5));  // lowest sheet at 13.5 mm: 1.5 mm deep
  std::vector<double> allowance(slab.below.size(), 0.0);
  std::vector<PointContact> at_rest;
  find_obstacle_contacts(slab.below, allowance, ball, Pose{}, slab.rest, {}, at_rest);
  allow_depths(at_rest, allowance);
  EXPECT_NEAR(*std::max_element(allowance.begin(), allowance.end()), 1.5, 0.05);
  const auto look = [&](const Nodes& x) {
    ContactLists lists(1);
    find_obstacle_contacts(slab.below, allowance, ball, Pose{}, x, {}, lists[0]);
    return lists;
  };
  Nodes x = slab.rest;
  MeshLoads loads = slab.held_at(Vector3d::Zero());
  settle(slab.mesh, HeldSlab::sheets, loads, look, x);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT((x[i] - slab.rest[i]).norm(), 1e-6);
  loads = slab.held_at({0, 0, -6});
  settle(slab.mesh, HeldSlab::sheets, loads, look, x);
  EXPECT_LT(deepest(mesh, slab.below, x), 1.5 + 0.2);
  EXPECT_GT(deepest(mesh, slab.below, x), 1.0);
}

// Two slabs of one mesh, one above the other, are pushed together.
TEST(MeshContact, TwoSurfacesOfOneMeshPushEachOtherEqually) {
  const HeldSlab upper(9, Vector3d(0, 0, 8)), lower(9, Vector3d(0.7, 0.4, 0));
  // One mesh of both: the upper's lowest sheet lies 2 mm above the lower's topmost.
  SpringPrismMesh mesh = upper.mesh;
  Nodes rest = upper.rest;
  const int shift = upper.mesh.node_count;
  for (const auto& p : lower.rest) rest.push_back(p);
  mesh.node_count += lower.mesh.node_count;
  for (std::size_t s = 0; s < lower.mesh.spring_a.size(); ++s) {
    mesh.spring_a.push_back(lower.mesh.spring_a[s] + shift);
    mesh.spring_b.push_back(lower.mesh.spring_b[s] + shift);
    mesh.rest_length.push_back(lower.mesh.rest_length[s]);
    mesh.stiffness.push_back(lower.mesh.stiffness[s]);
    mesh.spring_layer.push_back(lower.mesh.spring_layer[s]);
    mesh.spring_sheet.push_back(lower.mesh.spring_sheet[s]);
  }
  for (std::size_t p = 0; p < lower.mesh.prisms.size(); ++p) {
    auto prism = lower.mesh.prisms[p];
    for (int& node : prism) node += shift;
    mesh.prisms.push_back(prism);
    mesh.rest_volume.push_back(lower.mesh.rest_volume[p]);
    mesh.volume_weight.push_back(lower.mesh.volume_weight[p]);
  }
  MeshLoads loads = upper.held_at({0, 0, -3});
  for (std::size_t i = 0; i < lower.mesh.anchor_node.size(); ++i) {
    mesh.anchor_node.push_back(lower.mesh.anchor_node[i] + shift);
    mesh.anchor_stiffness.push_back(lower.mesh.anchor_stiffness[i]);
    loads.anchor_target.push_back(lower.rest[lower.mesh.anchor_node[i]] + Vector3d(0, 0, 2));
  }
  std::vector<std::array<int, 3>> top;
  for (const auto& t : lower.triangles)
    top.push_back(
        {node_of(t[0], 0, 3) + shift, node_of(t[1], 0, 3) + shift, node_of(t[2], 0, 3) + shift});
  // Inner points only: those on the rim extend beyond the other's rim.
  std::vector<MeshPoint> points;
  for (int j = 1; j < 8; ++j)
    for (int i = 1; i < 8; ++i) points.push_back(MeshPoint::of_node(HeldSlab::lowest(j * 9 + i)));
  const std::vector<double> none(points.size(), 0.0);
  const MeshSurface surface(top, rest);
  const auto look = [&](const Nodes& x) {
    ContactLists lists(1);
    find_surface_contacts(points, none, surface, x, {.reach_mm = 6, .stiffness = 1}, lists[0]);
    return lists;
  };
  Nodes x = rest;
  const auto result = settle(mesh, HeldSlab::sheets, loads, look, x);
  int pressed = 0;
  for (const auto& contact : result.contacts[0]) {
    EXPECT_GT(contact.gap, -0.2);
    pressed += contact.gap < 0;
    double sum = 0;
    for (int k = 0; k < contact.spring.count; ++k) sum += contact.spring.weight[k];
    EXPECT_NEAR(sum, 0, 1e-12);  // what one side feels the other feels too
  }
  EXPECT_GT(pressed, 10);
  // Both deform equally, being equal.
  const double sunk = rest[HeldSlab::lowest(40)].z() - x[HeldSlab::lowest(40)].z();
  const double raised = x[shift + node_of(40, 0, 3)].z() - rest[shift + node_of(40, 0, 3)].z();
  EXPECT_NEAR(3 - sunk, 2 - raised, 0.3);
  EXPECT_GT(3 - sunk, 1);
}

}  // namespace
}  // namespace condyle
