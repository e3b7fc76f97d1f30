#include "sim/dynamics/release_body.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <numbers>

#include "engine/core/error.h"
#include "sim/dynamics/jaw_world.h"
#include "tests/support/boxes.h"
#include "tests/support/builtin.h"
#include "tests/support/overlap_oracle.h"
#include "tests/support/real_cases.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using test::builtin;

/// Largest displacement of points up to a radius from the origin (80 mm: of a jaw) between two
/// poses.
double apart(const Pose& a, const Pose& b, double radius_mm = 80) {
  return (a.t - b.t).norm() + radius_mm * rotation_angle(a.inverse() * b);
}

/// The mandible opened about its condyles.
Pose opened(const Case& of, double degrees) {
  const Vector3d c =
      0.5 * (*of.landmarks.find("left_condyle") + *of.landmarks.find("right_condyle"));
  Pose X;
  X.R = Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vector3d::UnitX());
  X.t = c - X.R * c;
  return X;
}

struct Closed {
  Pose X_CM;
  double deepest_mm = 0;
};
/// Closes from an opening, and observes it at rest for ten seconds.
Closed close(const Case& of) {
  JawWorld jaw = make_jaw_world(of, {.X_CM = opened(of, 8)}, 2);
  double error = 0;
  const Rest rest = run_to_rest(jaw.world, jaw.mandible);
  EXPECT_TRUE(rest.reached);
  EXPECT_LT(rest.depth_mm, 0.05);
  const Pose X = jaw.world.pose(jaw.mandible);
  double drift = 0, jitter = 0;
  Pose last = X;
  for (int k = 0; k < 10000; ++k) {
    error = std::max(error, jaw.world.step().joint_error_mm);
    drift = std::max(drift, apart(X, jaw.world.pose(jaw.mandible)));
    jitter = std::max(jitter, apart(last, jaw.world.pose(jaw.mandible)));
    last = jaw.world.pose(jaw.mandible);
  }
  EXPECT_LT(drift, 0.01);
  EXPECT_LT(jitter, 1e-5);
  EXPECT_LT(error, 0.02);
  double push = 0;
  for (const auto& contact : jaw.world.contacts()) push += contact.push_N;
  EXPECT_GT(push, 20);
  EXPECT_GE(jaw.world.contacts().size(), 2u);  // and both condyles
  const test::OverlapOracle upper(of.find(Role::upper_teeth)->mesh),
      lower(of.find(Role::lower_teeth)->mesh);
  return {X, deepest(upper, lower, X)};
}

TEST(Jaw, ClosesUnderAForceIntoTheBuiltInBite) {
  const Closed closed = close(builtin());
  const Vector3d incisor = *builtin().landmarks.find("lower_incisal_point");
  EXPECT_LT((closed.X_CM * incisor - incisor).norm(), 1);
  EXPECT_LT(closed.deepest_mm, 0.06);
}

TEST(Jaw, ClosesTheSameOnTheCrownsOfABoneThatCarriesThem) {
  Case merged = builtin();
  const TriMesh crowns = merged.find(Role::upper_teeth)->mesh;
  std::erase_if(merged.parts, [](const Part& part) { return part.role == Role::upper_teeth; });
  int bones = 0;
  for (Part& part : merged.parts)
    if (part.role == Role::skull) part.mesh = test::joined(part.mesh, crowns), ++bones;
  ASSERT_EQ(bones, 1);
  const auto at_rest = [](const Case& of) {
    JawWorld jaw = make_jaw_world(of, {.X_CM = opened(of, 8)}, 2);
    EXPECT_TRUE(run_to_rest(jaw.world, jaw.mandible).reached);
    return jaw.world.pose(jaw.mandible);
  };
  EXPECT_LT(apart(at_rest(merged), at_rest(builtin())), 0.1);
}

TEST(Jaw, ClosesOnRealCrownsThatOverlapAtRest) {
  const auto real = test::case_ubc();
  if (!real) GTEST_SKIP() << "real anatomy absent";
  const Closed closed = close(*real);
  EXPECT_GT(closed.X_CM.t.norm() + rotation_angle(closed.X_CM), 0.01);  // held open by the crowns
  EXPECT_LT(closed.deepest_mm, 0.06);
}

/// The built-in patient with a curved block above the rear of the body of its mandible, pressed
/// against its outer side.
Case with_graft(Pose& start) {
  Case out = builtin();
  Part graft{"graft", Role::transplant, test::box({-9, -1.5, -4}, {9, 1.5, 4}), {}};
  // Bent about the vertical, finer along its length.
  TriMesh bent;
  const int n = 24;
  for (int i = 0; i <= n; ++i) {
    const double angle = 0.5 * (2.0 * i / n - 1), radius = 20;
    for (const auto& [r, z] : {std::pair{-1.5, -4.0}, {1.5, -4.0}, {1.5, 4.0}, {-1.5, 4.0}})
      bent.vertices.emplace_back((radius + r) * std::sin(angle),
                                 (radius + r) * std::cos(angle) - radius, z);
  }
  const auto quad = [&](int a, int b, int c, int d) {
    bent.triangles.emplace_back(a, b, c);
    bent.triangles.emplace_back(a, c, d);
  };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 4; ++k) {
      const int l = (k + 1) % 4;
      quad(4 * i + k, 4 * i + l, 4 * (i + 1) + l, 4 * (i + 1) + k);
    }
  quad(0, 3, 2, 1);
  quad(4 * n, 4 * n + 1, 4 * n + 2, 4 * n + 3);
  if (signed_volume(bent) < 0)
    for (auto& t : bent.triangles) std::swap(t[0], t[1]);
  graft.mesh = bent;
  out.add_piece(graft, mandible_body);
  // In front of the chin, facing it.
  const Vector3d chin = *out.landmarks.find("pogonion");
  start.R = Eigen::AngleAxisd(0.15, Vector3d(1, 0.4, 0.2).normalized()) *
            Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitZ());
  start.t = chin + Vector3d(1, -7, 1);
  return out;
}

TEST(Release, AGraftSettlesOnTheMandibleAndStays) {
  Pose start;
  const Case with = with_graft(start);
  const std::size_t part = with.parts.size() - 1;
  const BodyPoses from({Pose{}, Pose{}, start});
  const ReleaseSettings settings{.push_N = {0, 5, 0}};
  const Release settled = release_body(with, BodyId{2}, from, settings, 2);
  EXPECT_TRUE(settled.rest.reached);
  EXPECT_LT(settled.rest.depth_mm, 0.05);
  EXPECT_GE(settled.contacts.size(), 3u);
  Vector3d push = Vector3d::Zero();
  for (const auto& contact : settled.contacts) {
    EXPECT_EQ(with.parts[static_cast<std::size_t>(contact.part)].role, Role::mandible);
    push += contact.push_N * contact.normal;
  }
  EXPECT_NEAR(push.y(), -5, 1.5);  // the rest is friction's
  const Pose& X = settled.poses[BodyId{2}];
  EXPECT_GT((X.t - start.t).norm(), 1);
  const test::OverlapOracle bone(with.find(Role::mandible)->mesh), graft(with.parts[part].mesh);
  EXPECT_LT(deepest(bone, graft, X), 0.06);
  // Released again where it lies, it stays.
  const Release again = release_body(with, BodyId{2}, settled.poses, settings, 1);
  EXPECT_LT(apart(again.poses[BodyId{2}], X, 10), 0.02);
  // Bit-identical on one thread.
  const Release alone = release_body(with, BodyId{2}, from, settings, 1);
  EXPECT_EQ(alone.poses[BodyId{2}].t, X.t);
  EXPECT_EQ(alone.poses[BodyId{2}].R.coeffs(), X.R.coeffs());
}

TEST(Release, GraftsPushEachOtherOntoTheMandible) {
  Pose start;
  Case with = with_graft(start);
  Part another = with.parts.back();
  another.name = "another";
  with.add_piece(another, mandible_body);
  const std::size_t first = with.parts.size() - 2, second = first + 1;
  const Pose behind = Pose{Eigen::Quaterniond::Identity(), {1, -5, 0}} * start;
  const BodyPoses from({Pose{}, Pose{}, start, behind});
  ReleaseSettings settings{.push_N = {0, 5, 0}};
  settings.yielding = {BodyId{2}};
  const Release settled = release_body(with, BodyId{3}, from, settings, 2);
  EXPECT_TRUE(settled.rest.reached);
  EXPECT_LT(settled.rest.depth_mm, 0.05);
  const int jaw = static_cast<int>(with.find(Role::mandible) - with.parts.data());
  std::map<std::pair<int, int>, double> push;  // backward; by supporting part
  for (const auto& contact : settled.contacts)
    push[{contact.lies, contact.part}] -= contact.push_N * contact.normal.y();
  // The hand's push is transmitted through the first to the bone.
  const int a = static_cast<int>(first), b = static_cast<int>(second);
  EXPECT_GT((push[{b, a}]), 1);
  EXPECT_GT((push[{a, jaw}]), 1);
  EXPECT_NEAR((push[{b, a}] + push[{b, jaw}]), 5, 1.5);  // the rest is friction's
  EXPECT_NEAR((push[{a, jaw}] + push[{b, jaw}]), 5, 1.5);
  const Pose &A = settled.poses[BodyId{2}], &B = settled.poses[BodyId{3}];
  EXPECT_GT((A.t - start.t).norm(), 1);
  EXPECT_GT((B.t - behind.t).norm(), 1);
  const test::OverlapOracle bone(with.find(Role::mandible)->mesh), graft(another.mesh);
  EXPECT_LT(deepest(bone, graft, A), 0.06);
  EXPECT_LT(deepest(bone, graft, B), 0.06);
  EXPECT_LT(deepest(graft, graft, A.inverse() * B), 0.06);
  const Release alone = release_body(with, BodyId{3}, from, settings, 1);
  EXPECT_EQ(alone.poses[BodyId{3}].t, B.t);
  EXPECT_EQ(alone.poses[BodyId{2}].R.coeffs(), A.R.coeffs());
  settings.yielding = {BodyId{2}, BodyId{3}};
  EXPECT_THROW(release_body(with, BodyId{3}, from, settings), InputError);
}

TEST(Release, ABodyThatCannotComeToRestIsRefused) {
  Pose start;
  const Case with = with_graft(start);
  const BodyPoses from({Pose{}, Pose{}, start});
  EXPECT_THROW(release_body(with, cranium_body, from, {.push_N = {0, 5, 0}}), InputError);
  EXPECT_THROW(release_body(with, BodyId{2}, from, {}), InputError);
  const BodyPoses far({Pose{}, Pose{}, Pose{start.R, start.t - Vector3d(0, 200, 0)}});
  EXPECT_THROW(release_body(with, BodyId{2}, far, {.push_N = {0, 5, 0}}), InputError);
}

}  // namespace
}  // namespace condyle
