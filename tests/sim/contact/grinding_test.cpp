#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <set>

#include "engine/collide/collision_mesh.h"
#include "engine/collide/slide.h"
#include "engine/collide/solid.h"
#include "engine/mesh/refine.h"
#include "sim/phantom/phantom.h"
#include "tests/support/overlap_oracle.h"
#include "tests/support/real_cases.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

const TriMesh& surface(const Case& patient, Role role) {
  for (const auto& part : patient.parts)
    if (part.role == role) return part.mesh;
  throw std::runtime_error("no such part");
}

/// Closes from 6 mm below and grinds sideways in both directions, rotating about the vertical,
/// while it presses the arches up to 0.8 mm past their bite.
Pose target_at(double s) {
  const Vector3d condyles(0, 30, 75);
  const double round = 2 * std::numbers::pi * s;
  Pose X;
  X.R = Eigen::AngleAxisd(0.03 * std::sin(5 * round), Vector3d(0.3, 0.2, 1).normalized());
  const double closing = std::min(1.0, 10 * s);
  const double press = s > 0.1 ? 0.4 * (1 - std::cos(6 * round)) : 0;
  X.t = Vector3d(3 * std::sin(3 * round), 2 * std::sin(2 * round + 1) - 2 * std::sin(1.0),
                 6 * closing - 6 + press) +
        condyles - X.R * condyles;
  return X;
}

/// The lower crowns against the upper ones.
SlidingContact arches(const Case& patient) {
  const auto body = [&](Role role) {
    return std::make_shared<const ContactSurface>(
        make_contact_surface(surface(patient, role), {}, 2));
  };
  return SlidingContact({body(Role::upper_teeth)}, {body(Role::lower_teeth)});
}

TEST(Grinding, CrownsSlideOnCrownsWithoutOverlap) {
  const auto patient = test::case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const TriMesh &upper = surface(*patient, Role::upper_teeth),
                &lower = surface(*patient, Role::lower_teeth);
  const SlidingContact model = arches(*patient);
  const CollisionMesh upper_mesh(upper), lower_mesh(lower);
  const test::OverlapOracle upper_oracle(upper), lower_oracle(lower);
  const Solid upper_solid(upper), lower_solid(lower);

  SlideCache memory;
  Pose X{Eigen::Quaterniond::Identity(), {0, 0, -6}};
  std::vector<double> depths, proved;
  constexpr int frames = 330;
  for (int f = 0; f < frames; ++f) {
    const Pose target = target_at(static_cast<double>(f) / frames);
    const SlideResult result = model.slide(X, target, &memory);
    X = result.X_FM;
    if (contacts(upper_mesh, {}, lower_mesh, target).size() < 50) continue;
    EXPECT_TRUE(result.touching);
    depths.push_back(deepest(upper_oracle, lower_oracle, X));
    const OverlapDepth exact = overlap_depth(upper_solid, {}, lower_solid, X);
    proved.push_back(exact.depth_mm + exact.error_mm);
    // At rest it stays.
    EXPECT_EQ(model.slide(X, target, &memory).X_FM.t, X.t);
  }
  ASSERT_GE(depths.size(), 300u);
  for (auto* sorted : {&depths, &proved}) {
    std::sort(sorted->begin(), sorted->end());
    EXPECT_LE(sorted->back(), 0.1);
    EXPECT_LE((*sorted)[sorted->size() / 2], 0.05);
  }
}

/// The same surface with its edges halved, the longest first, until it has about 50,000 triangles.
TriMesh refined(TriMesh mesh) {
  const Vector3d center = bounding_box(mesh).center();
  for (double edge = 1; mesh.triangles.size() < 49000 && edge > 0.02; edge *= 0.97)
    mesh = refine_near(std::move(mesh), center, 100, edge, 100000);
  return mesh;
}

/// Triangle pairs that cross or lie within the slop of each other: those that cross at the pose or
/// once the lower crowns have moved by the slop against what holds them. (Not all of the pairs so
/// near: others would cross after a move in another direction.)
std::size_t pairs_in_touch(const CollisionMesh& upper, const CollisionMesh& lower,
                           const SlideResult& result) {
  Vector3d out = Vector3d::Zero();
  for (const SlideContact& contact : result.contacts) out += contact.push_mm * contact.normal;
  Pose pressed = result.X_FM;
  pressed.t -= SlideSettings{}.slop_mm * out.normalized();
  std::set<std::pair<int, int>> pairs;
  for (const Pose& X : {result.X_FM, pressed})
    for (const MeshContact& contact : contacts(upper, {}, lower, X))
      pairs.emplace(contact.triangles.a, contact.triangles.b);
  return pairs.size();
}

TEST(Grinding, ArchesOfFiftyThousandTrianglesSlideWithManyContactsAndWithoutOverlap) {
  const Case patient = builtin_patient();
  const TriMesh upper = refined(surface(patient, Role::upper_teeth)),
                lower = refined(surface(patient, Role::lower_teeth));
  EXPECT_GE(upper.triangles.size(), 49000u);
  EXPECT_GE(lower.triangles.size(), 49000u);
  const auto body = [](const TriMesh& mesh) {
    return std::make_shared<const ContactSurface>(make_contact_surface(mesh, {}, 2));
  };
  const SlidingContact model({body(upper)}, {body(lower)});
  const CollisionMesh upper_mesh(upper), lower_mesh(lower);
  const test::OverlapOracle upper_oracle(upper), lower_oracle(lower);
  const Solid upper_solid(upper), lower_solid(lower);

  SlideCache memory;
  Pose X{Eigen::Quaterniond::Identity(), {0, 0, -6}};
  std::vector<double> depths, proved;
  int counted = 0;
  constexpr int frames = 540;
  for (int f = 0; f < frames && counted < 300; ++f) {
    const SlideResult result = model.slide(X, target_at(static_cast<double>(f) / frames), &memory);
    X = result.X_FM;
    const std::size_t n = result.touching ? pairs_in_touch(upper_mesh, lower_mesh, result) : 0;
    if (n < 50) continue;
    ++counted;
    depths.push_back(deepest(upper_oracle, lower_oracle, X));
    const OverlapDepth exact =
        overlap_depth(upper_solid, {}, lower_solid, X, {.max_evaluations = 200000});
    proved.push_back(exact.depth_mm + exact.error_mm);
  }
  EXPECT_EQ(counted, 300);
  for (auto* sorted : {&depths, &proved}) {
    std::sort(sorted->begin(), sorted->end());
    EXPECT_LE(sorted->back(), 0.1);
    EXPECT_LE((*sorted)[sorted->size() / 2], 0.05);
  }
}

TEST(Grinding, CrownsRubWithFrictionWithoutOverlapAndRestWhereTheHandRests) {
  const Case patient = builtin_patient();
  const TriMesh &upper = surface(patient, Role::upper_teeth),
                &lower = surface(patient, Role::lower_teeth);
  const auto body = [](const TriMesh& mesh) {
    return std::make_shared<const ContactSurface>(make_contact_surface(mesh, {}, 2));
  };
  SlideSettings settings;
  settings.friction = 0.3;
  const SlidingContact free({body(upper)}, {body(lower)}),
      rough({body(upper)}, {body(lower)}, settings);
  const test::OverlapOracle upper_oracle(upper), lower_oracle(lower);
  Pose X{Eigen::Quaterniond::Identity(), {0, 0, -6}}, Y = X;
  std::vector<double> depths;
  double rough_path = 0, free_path = 0;
  constexpr int frames = 120;
  for (int f = 0; f < frames; ++f) {
    const Pose target = target_at(static_cast<double>(f) / frames);
    const SlideResult result = rough.slide(X, target);
    const Pose smooth = free.slide(Y, target).X_FM;
    if (f > 0) {
      rough_path += (result.X_FM.t - X.t).norm();
      free_path += (smooth.t - Y.t).norm();
    }
    X = result.X_FM;
    Y = smooth;
    if (!result.touching) continue;
    depths.push_back(deepest(upper_oracle, lower_oracle, X));
    EXPECT_LE((rough.slide(X, target).X_FM.t - X.t).norm(), 0.02) << f;
  }
  ASSERT_GT(depths.size(), 60u);
  std::sort(depths.begin(), depths.end());
  EXPECT_LE(depths.back(), 0.1);
  EXPECT_LE(depths[depths.size() / 2], 0.05);
  EXPECT_LT(rough_path, 0.98 * free_path) << "friction holds it back";
}

/// Largest distance of any point of the lower crowns between two poses.
double crowns_apart(const TriMesh& lower, const Pose& a, const Pose& b) {
  double most = 0;
  for (std::size_t i = 0; i < lower.vertices.size(); i += 37)
    most = std::max(most, (a * lower.vertices[i] - b * lower.vertices[i]).norm());
  return most;
}

/// A target of the grinding is reached in one jump, in steps from the side, and backward.
void expect_one_answer(const Case& patient) {
  const SlidingContact model = arches(patient);
  const TriMesh& lower = surface(patient, Role::lower_teeth);
  SlideCache memory;
  Pose X{Eigen::Quaterniond::Identity(), {0, 0, -6}};
  int compared = 0;
  constexpr int frames = 330;
  for (int f = 0; f < frames; f += 2) {
    const Pose target = target_at(static_cast<double>(f) / frames);
    const SlideResult result = model.slide(X, target, &memory);
    X = result.X_FM;
    EXPECT_EQ(model.slide(X, target).X_FM.t, X.t) << f;  // at rest, with nothing remembered
    if (!result.touching || f % 30 != 0) continue;
    ++compared;
    const Pose open{Eigen::Quaterniond::Identity(), {0, 0, -8}};
    EXPECT_LE(crowns_apart(lower, model.slide(open, target, nullptr, 2).X_FM, X), 0.05) << f;
    for (const int steps : {10, 100}) {
      Pose side = target;
      side.t += Vector3d(1.5, 1, -5);
      Pose Y = side;
      for (int k = 1; k <= steps; ++k)
        Y = model.slide(Y, interpolate(side, target, static_cast<double>(k) / steps), &memory).X_FM;
      EXPECT_LE(crowns_apart(lower, Y, X), 0.05) << f << " in " << steps;
    }
    Pose back = X;
    for (int k = 6; k >= 0; k -= 2)
      back = model.slide(back, target_at(static_cast<double>(f + k) / frames)).X_FM;
    EXPECT_LE(crowns_apart(lower, back, X), 0.05) << f << " backwards";
  }
  EXPECT_GE(compared, 8);
}

TEST(Grinding, RealCrownsEndAtTheSamePoseOnAnyPath) {
  const auto patient = test::case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  expect_one_answer(*patient);
}

TEST(Grinding, BuiltInCrownsEndAtTheSamePoseOnAnyPath) { expect_one_answer(builtin_patient()); }

TEST(Grinding, CrownsSlideBitIdenticallyOnOneAndTwoThreads) {
  const SlidingContact model = arches(builtin_patient());
  Pose one{Eigen::Quaterniond::Identity(), {0, 0, -6}}, two = one;
  int touching = 0;
  for (int f = 0; f < 330; f += 10) {
    const Pose target = target_at(f / 330.0);
    const SlideResult result = model.slide(one, target, nullptr, 1);
    touching += result.touching;
    one = result.X_FM;
    two = model.slide(two, target, nullptr, 2).X_FM;
    EXPECT_EQ(one.t, two.t) << f;
    EXPECT_EQ(one.R.coeffs(), two.R.coeffs()) << f;
  }
  EXPECT_GT(touching, 20);
}

TEST(Grinding, ArchesDoNotPassThroughEachOtherInOneJump) {
  const auto patient = test::case_ubc();
  if (!patient) GTEST_SKIP() << "real anatomy absent";
  const TriMesh &upper = surface(*patient, Role::upper_teeth),
                &lower = surface(*patient, Role::lower_teeth);
  const SlidingContact model = arches(*patient);
  const Pose open{Eigen::Quaterniond::Identity(), {0, 0, -25}};
  const SlideResult result = model.slide(open, {Eigen::Quaterniond::Identity(), {1, 1, 20}});
  EXPECT_TRUE(result.touching);
  EXPECT_LT(result.X_FM.t.z(), 0.5);
  EXPECT_GT(result.X_FM.t.z(), -4);
  const test::OverlapOracle upper_oracle(upper), lower_oracle(lower);
  EXPECT_LE(deepest(upper_oracle, lower_oracle, result.X_FM), 0.1);
}

}  // namespace
}  // namespace condyle
