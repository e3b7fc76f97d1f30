#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/contact/contact.h"
#include "tests/support/boxes.h"
#include "tests/support/overlap_oracle.h"
#include "tests/support/real_cases.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using test::shift;

/// Axis along z, its caps at +-(radius + half) from the middle.
TriMesh capsule(double radius, double half) {
  TriMesh mesh = test::sphere(5, radius);
  for (auto& v : mesh.vertices) v.z() += v.z() > 0 ? half : -half;
  return mesh;
}

/// A cube that stands on one corner; the opposite one, its tip, is at `tip`.
TriMesh cube_on_corner(double edge, const Eigen::Vector3d& tip) {
  TriMesh mesh = test::box({-edge, -edge, -edge}, {0, 0, 0});
  const auto up =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d(1, 1, 1), Eigen::Vector3d::UnitZ());
  return test::moved(std::move(mesh), {up, tip});
}

struct NamedMesh {
  std::string name;
  TriMesh mesh;
};

/// All 40 mm high about the origin.
std::vector<NamedMesh> lower_bodies() {
  return {{"sphere", test::sphere(5, 20)},
          {"box", test::box({-20, -20, -20}, {20, 20, 20})},
          {"capsule", capsule(12, 8)}};
}

/// Their tops are at z = -22.
std::vector<NamedMesh> intruders() {
  return {{"sphere", test::sphere(5, 10, {0, 0, -32})},
          {"box", test::box({-8, -8, -40}, {8, 8, -22})},
          {"corner", cube_on_corner(12, {0, 0, -22})},
          {"capsule", test::moved(capsule(5, 6), shift(0, 0, -33))}};
}

TEST(RestOverlap, DepthOnTheOtherSideIsTheTrueOne) {
  int compared = 0;
  for (const auto& body : lower_bodies())
    for (const auto& intruder : intruders()) {
      SCOPED_TRACE(body.name + " on " + intruder.name);
      // 1 mm deep in a block above, 2 mm above the intruder.
      const ContactModel model(test::two_bones(
          test::joined(test::box({-30, -30, 19}, {30, 30, 40}), intruder.mesh), body.mesh));
      EXPECT_NEAR(model.at_rest().pairs[0].depth_mm, 1, 0.01);
      EXPECT_EQ(model.at_rest().max_penetration_mm(), 0);
      for (const double depth : {0.5, 1.0, 3.0}) {
        const ContactSet set = model.find(shift(0, 0, -2 - depth), nullptr);
        ASSERT_EQ(set.outside_rest_overlap.size(), 1u);
        EXPECT_NEAR(set.outside_rest_overlap[0].depth_mm, depth, 0.01 * depth);
        EXPECT_NEAR(set.max_penetration_mm(), depth, 0.01 * depth);
        EXPECT_LE(set.pairs[0].witness_a.z(), -22 + 1e-6);
        EXPECT_GE(set.pairs[0].witness_a.z(), -22 - depth - 1e-6);
        ++compared;
      }
    }
  EXPECT_EQ(compared, 36);
}

/// The crowns overlap at rest by 1.2 mm; the condyles are then driven into their fossae.
TEST(RestOverlap, CondylesOfARealJawPushedUpAreAsDeepAsIfNothingOverlapped) {
  auto patient = test::case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const Eigen::Vector3d condyles(0, 31.4501, 79.6370);
  const Eigen::Quaterniond R(Eigen::AngleAxisd(12 * M_PI / 180, Eigen::Vector3d::UnitX()));
  const Pose opened{R, condyles - R * condyles + Eigen::Vector3d(0, 0, 1.2)};
  const ContactSet overlapping = ContactModel(*patient).find(opened, nullptr);

  // The same surfaces in the same pose, but 2 mm apart at rest.
  for (auto& part : patient->parts)
    if (part.body == mandible_body) part.mesh = test::moved(std::move(part.mesh), shift(0, 0, -2));
  const ContactSet apart = ContactModel(*patient).find(opened * shift(0, 0, 2), nullptr);
  const PairContact& most =
      *std::max_element(apart.pairs.begin(), apart.pairs.end(),
                        [](const auto& x, const auto& y) { return x.depth_mm < y.depth_mm; });
  const Pose X_AB = opened * shift(0, 0, 2);
  const auto oracle = [&](int part, const Eigen::Vector3d& about) {
    constexpr double around_mm = 15;
    Box region;
    region.add(about - Eigen::Vector3d::Constant(around_mm));
    region.add(about + Eigen::Vector3d::Constant(around_mm));
    return test::OverlapOracle(patient->parts[static_cast<std::size_t>(part)].mesh, region);
  };
  const double sampled_mm = deepest(oracle(most.part_a, most.witness_a),
                                    oracle(most.part_b, X_AB.inverse() * most.witness_a), X_AB);
  EXPECT_GT(sampled_mm, 1);
  EXPECT_NEAR(apart.max_penetration_mm(), sampled_mm, 0.02 * sampled_mm);
  EXPECT_NEAR(overlapping.max_penetration_mm(), apart.max_penetration_mm(),
              0.01 * apart.max_penetration_mm());
}

/// A segment of the mandible that overlaps it by 1 mm as planned, and a maxilla 3 mm above both.
Case with_planned_overlap() {
  Case patient = test::two_bones(test::box({-40, -40, 13}, {40, 40, 30}),
                                 test::box({-40, -40, -20}, {0, 40, 10}));
  const BodyId segment = patient.bodies.add(
      {.name = "segment", .parent = mandible_body, .driver = BodyDriver::plan});
  patient.parts.push_back(
      {"segment", Role::segment, test::box({-1, -30, -20}, {30, 30, 10}), {}, segment});
  return patient;
}

TEST(RestOverlap, OfSegmentsThatAreTrimmedIsMeasuredButDoesNotStopADrag) {
  const ContactModel model(with_planned_overlap());
  const auto drag = [&](const Pose& X) {
    return model.slide({}, test::target_poses({}, {X}), nullptr);
  };
  const auto pair = [](const ContactSet& set) {
    for (const PairContact& one : set.pairs)
      if (one.part_a == 1 && one.part_b == 2) return one;
    ADD_FAILURE() << "the pair is missing";
    return PairContact{};
  };
  const ContactModel::Slide deeper = drag(test::shift(-2, 0, 0));
  EXPECT_FALSE(deeper.stopped);
  EXPECT_NEAR(pair(deeper.contacts).depth_mm, 3, 1e-6);
  EXPECT_NEAR(pair(deeper.contacts).rest_depth_mm, 1, 1e-6);
  EXPECT_NEAR(deeper.contacts.max_penetration_mm(), 2, 1e-6);
  EXPECT_EQ(pair(model.find(deeper.at, nullptr)).depth_mm, pair(deeper.contacts).depth_mm);

  const ContactModel::Slide up = drag(test::shift(-2, 0, 5));  // against the maxilla
  EXPECT_TRUE(up.stopped);
  EXPECT_NEAR(up.at[BodyId{2}].t.z(), 3, 0.03);
  EXPECT_NEAR(up.at[BodyId{2}].t.x(), -2, 0.03);

  const ContactModel::Slide away = drag(test::shift(2, 0, 0));
  EXPECT_FALSE(away.stopped);
  EXPECT_FALSE(pair(away.contacts).touching);
  EXPECT_NEAR(pair(away.contacts).distance_mm, 1, 1e-6);

  Case grafted = with_planned_overlap();
  grafted.parts.back().role = Role::transplant;
  grafted.pair_rules.push_back({"mandible", "segment", PairPolicy::cut_face, std::nullopt, 0});
  const ContactModel::Slide held = ContactModel(grafted).slide(
      {}, test::target_poses({}, {test::shift(-2, 0, 0)}), nullptr);
  EXPECT_TRUE(held.stopped);
}

/// The jaw carries the segment: their answer is the one at rest, moved.
TEST(RestOverlap, OfBodiesThatMoveAsOneIsCarriedAlong) {
  const ContactModel model(with_planned_overlap());
  const Pose X{Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX())), {1, 2, -9}};
  const ContactSet moved = model.find(with_jaw_at(with_planned_overlap().bodies, X), nullptr);
  ASSERT_EQ(moved.pairs.size(), model.at_rest().pairs.size());
  bool compared = false;
  for (std::size_t i = 0; i < moved.pairs.size(); ++i) {
    const PairContact &now = moved.pairs[i], &rest = model.at_rest().pairs[i];
    if (now.part_a != 1) continue;
    EXPECT_EQ(now.depth_mm, rest.depth_mm);
    ASSERT_EQ(now.contacts.size(), rest.contacts.size());
    ASSERT_FALSE(now.contacts.empty());
    EXPECT_LT((now.contacts[0].point - X * rest.contacts[0].point).norm(), 1e-9);
    EXPECT_LT((now.witness_a - X * rest.witness_a).norm(), 1e-9);
    compared = true;
  }
  EXPECT_TRUE(compared);
}

}  // namespace
}  // namespace condyle
