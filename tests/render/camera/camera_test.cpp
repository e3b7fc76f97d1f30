#include "render/camera/camera.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <set>

#include "engine/core/error.h"

namespace condyle {
namespace {

const Eigen::Vector3d low(-75, -120, -100), high(75, 100, 120);

TEST(Camera, EveryNamedViewShowsTheWholeBoxAndFillsThePicture) {
  ASSERT_EQ(camera_names().size(), 7u);
  for (const auto& name : camera_names())
    for (const double aspect : {16.0 / 9, 1.0, 0.5}) {
      const Camera camera = standard_camera(name, low, high, aspect);
      const Eigen::Matrix4f clip = projection_matrix(camera, aspect, 1, 5000) * view_matrix(camera);
      float widest = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector4f q = clip * Eigen::Vector4f(float(corner & 1 ? high.x() : low.x()),
                                                         float(corner & 2 ? high.y() : low.y()),
                                                         float(corner & 4 ? high.z() : low.z()), 1);
        ASSERT_GT(q.w(), 0);
        widest = std::max({widest, std::abs(q.x() / q.w()), std::abs(q.y() / q.w())});
      }
      EXPECT_LT(widest, 1) << name << ' ' << aspect;
      EXPECT_GT(widest, 0.85) << name << ' ' << aspect;
    }
}

TEST(Camera, TheViewMatrixIsARigidMotionWithTheTargetAhead) {
  for (const auto& name : camera_names()) {
    const Camera camera = standard_camera(name, low, high, 1.5);
    const Eigen::Matrix4f view = view_matrix(camera);
    const Eigen::Matrix3f R = view.topLeftCorner<3, 3>();
    EXPECT_TRUE((R * R.transpose()).isIdentity(1e-5f)) << name;
    EXPECT_NEAR(R.determinant(), 1, 1e-5) << name;
    const Eigen::Vector4f target = view * camera.target.cast<float>().homogeneous();
    EXPECT_NEAR(target.x(), 0, 1e-3);
    EXPECT_NEAR(target.y(), 0, 1e-3);
    EXPECT_NEAR(target.z(), -camera.distance_mm, 1e-2);
  }
}

/// Where a point appears: x to the right, y up.
Eigen::Vector2f seen(const Camera& camera, const Eigen::Vector3d& p) {
  const Eigen::Vector4f q =
      projection_matrix(camera, 1, 1, 5000) * view_matrix(camera) * p.cast<float>().homogeneous();
  return q.head<2>() / q.w();
}

TEST(Camera, NamesMeanThePatientsSides) {
  const auto view = [](const char* name) { return standard_camera(name, -low, low, 1); };
  const Eigen::Vector3d left(50, 0, 0), nose(0, -50, 0), crown(0, 0, 50);
  EXPECT_GT(seen(view("front"), left).x(), 0.1);  // facing us, his left is on our right
  EXPECT_LT(seen(view("back"), left).x(), -0.1);
  EXPECT_LT(seen(view("left"), nose).x(), -0.1);  // his left side: the nose points to our left
  EXPECT_GT(seen(view("right"), nose).x(), 0.1);
  EXPECT_LT(seen(view("three-quarter"), nose).x(), -0.05);
  EXPECT_GT(seen(view("above"), nose).y(), 0.1);
  EXPECT_GT(seen(view("below"), nose).y(), 0.1);
  EXPECT_GT(seen(view("above"), left).x() * seen(view("below"), left).x(), -1);
  EXPECT_LT(seen(view("above"), left).x() * seen(view("below"), left).x(), 0);
  for (const char* name : {"front", "back", "left", "right", "three-quarter"})
    EXPECT_GT(seen(view(name), crown).y(), 0.1) << name;
}

TEST(Camera, AFullTurnComesBackAndAQuarterShowsTheSide) {
  const Camera front = standard_camera("front", low, high, 1);
  EXPECT_TRUE(turned(front, 2 * std::numbers::pi).direction.isApprox(front.direction, 1e-12));
  EXPECT_TRUE(
      turned(front, std::numbers::pi / 2).direction.isApprox(Eigen::Vector3d(1, 0, 0), 1e-12));
  EXPECT_DOUBLE_EQ(turned(front, 1).distance_mm, front.distance_mm);
  // Expressed in another frame it turns about the same axis.
  const Pose X{Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized())),
               Eigen::Vector3d(5, 6, 7)};
  const Camera there = turned(expressed_in(X, front), 1, X.R * Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(there.direction.isApprox(expressed_in(X, turned(front, 1)).direction, 1e-12));
  EXPECT_TRUE(there.up.isApprox(expressed_in(X, turned(front, 1)).up, 1e-12));
}

TEST(Camera, AViewAlongUpIsValid) {
  Camera camera;
  camera.direction = camera.up = {0, 0, 1};
  EXPECT_TRUE(view_matrix(camera).allFinite());
  EXPECT_NEAR((view_matrix(camera).topLeftCorner<3, 3>().determinant()), 1, 1e-5);
}

TEST(Camera, AnUnknownNameIsRefusedWithTheKnownOnes) {
  try {
    standard_camera("sideways", low, high, 1);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("sideways"), std::string::npos);
    for (const auto& name : camera_names())
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
  }
}

}  // namespace
}  // namespace condyle
