#include "sim/contact/distance_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/collide/signed_surface.h"
#include "engine/mesh/triangle_tree.h"
#include "tests/support/boxes.h"
#include "tests/support/real_cases.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using test::box;
using test::sphere;

/// The patient of boxes with a graft on the mandible and a piece beside it.
Case patient_with_pieces() {
  Case patient = test::box_patient();
  patient.add_piece({"graft", Role::transplant, box({-10, -80, -41}, {10, -60, -40.4}), {}},
                    mandible_body);
  patient.add_piece({"piece", Role::segment, box({35, -80, -30}, {45, -60, -20}), {}},
                    cranium_body);
  return patient;
}

const DistanceMap::Surface& surface_of(const DistanceMap& map, const Case& patient,
                                       const std::string& name, std::size_t& place) {
  for (place = 0; place < map.surfaces().size(); ++place)
    if (patient.parts[static_cast<std::size_t>(map.surfaces()[place].part)].name == name)
      return map.surfaces()[place];
  throw std::runtime_error("no surface " + name);
}

/// Distance of each point to those parts, by exact search.
std::vector<float> oracle(const Case& patient, const std::vector<std::string>& others,
                          const DistanceMap::Surface& surface, const BodyPoses& poses,
                          double reach_mm) {
  std::vector<float> least(surface.mesh.vertices.size(), INFINITY);
  for (std::size_t k = 0; k < patient.parts.size(); ++k) {
    if (std::find(others.begin(), others.end(), patient.parts[k].name) == others.end()) continue;
    const SignedSurface other(patient.parts[k].mesh);
    const Pose X = pose_of(patient.parts[k], poses).inverse() *
                   pose_of(patient.parts[static_cast<std::size_t>(surface.part)], poses);
    for (std::size_t v = 0; v < least.size(); ++v)
      least[v] =
          std::min(least[v], static_cast<float>(other.distance(X * surface.mesh.vertices[v])));
  }
  for (float& d : least)
    if (std::abs(d) > reach_mm) d = d > 0 ? INFINITY : -INFINITY;
  return least;
}

/// Returns the number of vertices beyond the reach.
int expect_equal(const std::vector<float>& found, const std::vector<float>& truth,
                 double reach_mm) {
  EXPECT_EQ(found.size(), truth.size());
  int near = 0, beyond = 0;
  for (std::size_t v = 0; v < found.size(); ++v) {
    const bool both = std::isfinite(found[v]) && std::isfinite(truth[v]);
    if (both) {
      EXPECT_NEAR(found[v], truth[v], 1e-3);
    } else if (std::isfinite(found[v]) || std::isfinite(truth[v])) {
      // At the very end of the reach rounding decides.
      EXPECT_NEAR(std::abs(std::isfinite(found[v]) ? found[v] : truth[v]), reach_mm, 1e-3);
    } else {
      EXPECT_EQ(found[v], truth[v]);
    }
    (both ? near : beyond) += 1;
  }
  EXPECT_GT(near, 20);
  return beyond;
}

TEST(DistanceMap, IsTheExactDistanceToPartsThatMayTouch) {
  const Case patient = patient_with_pieces();
  const DistanceMap map(patient, {.reach_mm = 3}, 2);
  ASSERT_EQ(map.surfaces().size(), 4u);
  Pose X_CM, X_CP;
  X_CM.t = {0.5, 1, 1.5};  // half a millimetre into the maxilla
  X_CM.R = Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitX());
  X_CP.t = {-7, 0, 2};  // into the maxilla, its parent
  const BodyPoses poses({Pose{}, X_CM, X_CM, X_CP});
  const auto values = map.at(poses, 2);
  const std::vector<std::pair<std::string, std::vector<std::string>>> meets = {
      {"maxilla", {"mandible", "graft"}},
      {"mandible", {"maxilla", "piece"}},
      {"graft", {"maxilla", "piece"}}};
  int beyond = 0;
  for (const auto& [name, others] : meets) {
    SCOPED_TRACE(name);
    std::size_t s = 0;
    const auto& surface = surface_of(map, patient, name, s);
    beyond += expect_equal(values[s], oracle(patient, others, surface, poses, 3), 3);
  }
  EXPECT_GT(beyond, 100);
  // The piece is far from all but its carrier, from which it was cut.
  std::size_t s = 0;
  surface_of(map, patient, "piece", s);
  for (const float d : values[s]) EXPECT_EQ(d, INFINITY);
}

TEST(DistanceMap, ARuleBringsInAPairThatIsLeftOutAsCut) {
  const Case patient = patient_with_pieces();
  const DistanceMap map(patient,
                        {.pair_rules = {{"piece", "maxilla", PairPolicy::forbidden, {}, 0}}});
  const BodyPoses poses({Pose{}, Pose{}, Pose{}, {Eigen::Quaterniond::Identity(), {-4, 0, 0}}});
  std::size_t s = 0;
  surface_of(map, patient, "piece", s);
  const auto values = map.at(poses)[s];
  EXPECT_NEAR(*std::min_element(values.begin(), values.end()), 1, 1e-4);
}

TEST(DistanceMap, SurfacesAreThePartsWithSmallerTrianglesWhereTheyMayMeet) {
  const Case patient = patient_with_pieces();
  const DistanceMap map(patient, {.bone_edge_mm = 2});
  for (const auto& surface : map.surfaces()) {
    const auto& mesh = patient.parts[static_cast<std::size_t>(surface.part)].mesh;
    ASSERT_EQ(surface.normals.size(), surface.mesh.vertices.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
      EXPECT_EQ(surface.mesh.vertices[v], mesh.vertices[v]);
    EXPECT_NEAR(surface_area(surface.mesh), surface_area(mesh), 1e-6 * surface_area(mesh));
    const TriangleTree tree(mesh);
    double farthest = 0;
    for (const auto& v : surface.mesh.vertices)
      farthest = std::max(farthest, tree.nearest(v).distance);
    EXPECT_LT(farthest, 1e-9);
    EXPECT_GT(surface.mesh.vertices.size(), 50u);
    EXPECT_FALSE(surface.unsigned_near_open);
  }
}

TEST(DistanceMap, IsBitIdenticalForOneAndTwoThreadsAndAnyPreviousMap) {
  const Case patient = patient_with_pieces();
  const DistanceMap map(patient);
  std::mt19937_64 random(3);
  std::vector<BodyPoses> poses(6);
  for (auto& at : poses) at = test::any_pose(random, 1.5);
  for (auto& at : poses) at.X_CB[1].R = Eigen::Quaterniond::Identity().slerp(0.01, at.X_CB[1].R);
  std::vector<DistanceMap::Values> forward;
  for (const auto& at : poses) forward.push_back(map.at(at, 1));
  EXPECT_NE(forward[0], forward[1]);
  for (std::size_t i = poses.size(); i-- > 0;) EXPECT_EQ(map.at(poses[i], 2), forward[i]);
}

TEST(DistanceMap, WhatLiesDeepInsideIsMarked) {
  Case patient;
  patient.parts.push_back({"maxilla", Role::maxilla, sphere(3, 30), {}});
  patient.parts.push_back({"mandible", Role::mandible, sphere(2, 10), {}});
  const DistanceMap map(patient);
  const auto values = map.at({});
  for (const float d : values[1]) EXPECT_EQ(d, -INFINITY);
  for (const float d : values[0]) EXPECT_EQ(d, INFINITY);
}

TEST(DistanceMap, NearOpenShellsDistanceHasNoSign) {
  Case patient = test::box_patient();
  patient.parts[0].mesh.triangles.resize(10);  // a side is missing
  const DistanceMap map(patient);
  EXPECT_FALSE(map.surfaces()[0].unsigned_near_open);
  EXPECT_TRUE(map.surfaces()[1].unsigned_near_open);
  BodyPoses poses;
  poses = Pose{Eigen::Quaterniond::Identity(), {0, 0, 2}};
  const auto values = map.at(poses);
  int near = 0;
  for (const float d : values[1]) {
    EXPECT_GE(d, 0);
    near += d < 2;
  }
  EXPECT_GT(near, 20);
}

TEST(DistanceMap, RealCrownsThatOverlapAtRestAreFound) {
  const auto patient = test::case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const DistanceMap map(*patient, {}, 2);
  const auto values = map.at({}, 2);
  std::size_t s = 0;
  const auto& upper = surface_of(map, *patient, "upper-teeth", s);
  int overlap = 0;
  float deepest = 0;
  for (const float d : values[s]) {
    overlap += d < -0.1f;
    if (std::isfinite(d)) deepest = std::min(deepest, d);
  }
  EXPECT_GT(overlap, 200);
  EXPECT_LT(deepest, -1);
  const auto truth = oracle(*patient, {"mandible", "lower-teeth"}, upper, {}, 2);
  EXPECT_GT(expect_equal(values[s], truth, 2), 1000);
}

}  // namespace
}  // namespace condyle
