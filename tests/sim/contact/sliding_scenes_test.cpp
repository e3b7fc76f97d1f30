#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "engine/collide/collision_mesh.h"
#include "engine/collide/slide.h"
#include "engine/mesh/measure.h"
#include "tests/support/boxes.h"
#include "tests/support/builtin.h"
#include "tests/support/overlap_oracle.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using test::builtin;

/// Triangles whose centre lies in the box, with their vertices.
TriMesh within(const TriMesh& mesh, const Box& box) {
  TriMesh part;
  std::vector<int> at(mesh.vertices.size(), -1);
  for (const auto& t : mesh.triangles) {
    if (!box.contains((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3))
      continue;
    Eigen::Vector3i moved;
    for (int k = 0; k < 3; ++k) {
      if (at[t[k]] < 0) {
        at[t[k]] = static_cast<int>(part.vertices.size());
        part.vertices.push_back(mesh.vertices[t[k]]);
      }
      moved[k] = at[t[k]];
    }
    part.triangles.push_back(moved);
  }
  return part;
}

Box around(const Vector3d& p, double reach) {
  return {p - Vector3d::Constant(reach), p + Vector3d::Constant(reach)};
}

/// A body that slides on another, measured by exact distances.
struct Scene {
  Scene(const TriMesh& fixed, const TriMesh& moving, const SlideSettings& settings = {})
      : Scene(fixed, moving, test::OverlapOracle(fixed), test::OverlapOracle(moving), settings) {}
  /// For bodies that are only part of the reference surfaces: an open part has no inside.
  Scene(const TriMesh& fixed, const TriMesh& moving, test::OverlapOracle fixed_judge,
        test::OverlapOracle moving_judge, const SlideSettings& settings = {})
      : fixed_body(std::make_shared<const ContactSurface>(make_contact_surface(fixed, {}, 2))),
        moving_body(std::make_shared<const ContactSurface>(make_contact_surface(moving, {}, 2))),
        model({fixed_body}, {moving_body}, settings),
        fixed_oracle(std::move(fixed_judge)),
        moving_oracle(std::move(moving_judge)) {}

  /// Largest distance of any point of the moving body between two poses.
  double apart(const Pose& a, const Pose& b) const {
    double most = 0;
    for (std::size_t i = 0; i < moving_body->samples.points.size(); i += 23) {
      const Vector3d& p = moving_body->samples.points[i];
      most = std::max(most, (a * p - b * p).norm());
    }
    return most;
  }

  std::shared_ptr<const ContactSurface> fixed_body, moving_body;
  SlidingContact model;
  test::OverlapOracle fixed_oracle, moving_oracle;
};

struct Outcome {
  int touching = 0, reached_otherwise = 0, compared = 0;
  double median_depth = 0, deepest_mm = 0, rest_mm = 0, path_mm = 0;
};

/// Follows the targets and measures the pose of the body.
template <class Wanted>
Outcome follow(const Scene& scene, const Pose& start, int frames, const Wanted& target_at) {
  Outcome out;
  std::vector<double> depths;
  Pose X = start;
  SlideCache memory;
  for (int f = 0; f < frames; ++f) {
    const Pose target = target_at(static_cast<double>(f) / (frames - 1));
    const SlideResult result = scene.model.slide(X, target, &memory);
    EXPECT_TRUE(result.settled) << f;
    // Nothing but the poses counts, and what rests stays.
    EXPECT_EQ(scene.model.slide(X, target).X_FM.t, result.X_FM.t) << f;
    out.rest_mm = std::max(out.rest_mm,
                           scene.apart(scene.model.slide(result.X_FM, target).X_FM, result.X_FM));
    X = result.X_FM;
    if (!result.touching) continue;
    ++out.touching;
    depths.push_back(deepest(scene.fixed_oracle, scene.moving_oracle, X));
    if (f % 10 != 0) continue;
    // In one jump, and in ten and a hundred steps along another path.
    ++out.compared;
    out.path_mm = std::max(out.path_mm, scene.apart(scene.model.slide(start, target).X_FM, X));
    for (const int steps : {10, 100}) {
      Pose Y = start;
      for (int k = 1; k <= steps; ++k)
        Y = scene.model.slide(Y, interpolate(start, target, static_cast<double>(k) / steps)).X_FM;
      out.path_mm = std::max(out.path_mm, scene.apart(Y, X));
    }
  }
  std::sort(depths.begin(), depths.end());
  if (!depths.empty()) {
    out.deepest_mm = depths.back();
    out.median_depth = depths[depths.size() / 2];
  }
  ::testing::Test::RecordProperty("median_depth_um", static_cast<int>(1e3 * out.median_depth));
  ::testing::Test::RecordProperty("deepest_um", static_cast<int>(1e3 * out.deepest_mm));
  ::testing::Test::RecordProperty("path_um", static_cast<int>(1e3 * out.path_mm));
  return out;
}

void expect_lawful(const Outcome& out, int min_touching) {
  EXPECT_GE(out.touching, min_touching);
  EXPECT_GT(out.compared, 2);
  EXPECT_LE(out.deepest_mm, 0.1);
  EXPECT_LE(out.median_depth, 0.05);
  EXPECT_LE(out.rest_mm, 0.02);
  EXPECT_LE(out.path_mm, 0.05);
}

Pose at(const Vector3d& t) { return {Eigen::Quaterniond::Identity(), t}; }

TEST(SlidingScenes, CondyleGlidesOnTheEminence) {
  const Vector3d joint = *builtin().landmarks.find("left_condyle");
  const TriMesh &skull = builtin().find(Role::skull)->mesh,
                &mandible = builtin().find(Role::mandible)->mesh;
  const Scene scene(within(skull, around(joint, 16)), within(mandible, around(joint, 12)),
                    test::OverlapOracle(skull, around(joint, 25)),
                    test::OverlapOracle(mandible, around(joint, 12)));
  // Forward and down with the jaw, but pressed up into the fossa and the eminence.
  const Outcome out = follow(scene, at({0, 0, -4}), 60, [](double s) {
    return at({0.5 * std::sin(6 * s), -12 * s, 2.5 - 6 * s});
  });
  expect_lawful(out, 30);
  EXPECT_GT(out.deepest_mm, 1e-3) << "at least the sum of roundings: the measure is effective";
}

TEST(SlidingScenes, AGraftIsDraggedAlongTheMandible) {
  const Vector3d chin = *builtin().landmarks.find("pogonion");
  const TriMesh& mandible = builtin().find(Role::mandible)->mesh;
  const TriMesh bone = within(mandible, around(chin, 25));
  // A strut before the chin.
  const Box box = bounding_box(bone);
  const double front = box.low.y();
  const TriMesh graft = test::box({-8, -3, -3}, {8, 3, 3});
  const Vector3d before(chin.x(), front - 6, chin.z());
  const Outcome out = follow(
      Scene(bone, graft, test::OverlapOracle(mandible, around(chin, 25)),
            test::OverlapOracle(graft)),
      at(before), 60, [&](double s) {
        Pose X = at(before + Vector3d(24 * s - 12, 5 + 2 * std::sin(7 * s), 3 * std::sin(5 * s)));
        X.R = Eigen::AngleAxisd(0.5 * (s - 0.5), Vector3d::UnitZ());
        return X;
      });
  expect_lawful(out, 30);
}

TEST(SlidingScenes, ASegmentIsPushedIntoAGap) {
  // Two bone ends with rounded faces, narrower below, and a segment a little wider than the gap.
  const auto lean = [](double sign) {
    return test::moved(test::box({sign > 0 ? 0.0 : -12.0, -8, -10}, {sign > 0 ? 12.0 : 0.0, 8, 10}),
                       {Eigen::Quaterniond(Eigen::AngleAxisd(0.12 * sign, Vector3d::UnitY())),
                        Vector3d(sign * 5, 0, 0)});
  };
  const Scene scene(test::joined(lean(1), lean(-1)), test::sphere(4, 5.5, {0, 0, 0}, 0.03));
  const Outcome out = follow(scene, at({0.3, 0, 20}), 60, [](double s) {
    Pose X = at({0.8 * std::sin(9 * s), 3 * s, 12 - 14 * s});
    X.R = Eigen::AngleAxisd(0.3 * std::sin(4 * s), Vector3d(1, 0.4, 0.2).normalized());
    return X;
  });
  expect_lawful(out, 20);
}

}  // namespace
}  // namespace condyle
