#include "render/window/input/camera_control.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double pi = std::numbers::pi;
const ViewRect window_view{240, 46, 800, 600};
const ZoomLimits limits{.nearest_mm = 50, .farthest_mm = 3000};

Camera any_camera(std::mt19937& generator) {
  std::uniform_real_distribution<double> one(-1, 1);
  const auto random = [&] { return one(generator); };
  Camera camera;
  camera.target = 100 * Vector3d(random(), random(), random());
  camera.distance_mm = 500 + 200 * random();
  return with_angles(camera,
                     {.azimuth = 3 * random(), .elevation = 1.4 * random(), .roll = 3 * random()});
}

/// Position of a point of the case in the window, pixels.
Vector2d pixel_of(const Camera& camera, const Vector3d& point) {
  const Eigen::Vector4f clip =
      projection_matrix(camera, window_view.width / window_view.height, 1, 10000) *
      view_matrix(camera) *
      Eigen::Vector4f(float(point.x()), float(point.y()), float(point.z()), 1);
  return {window_view.x + window_view.width * (0.5 + 0.5 * clip.x() / clip.w()),
          window_view.y + window_view.height * (0.5 - 0.5 * clip.y() / clip.w())};
}

TEST(CameraControl, ButtonsMeanWhatTheHelpSays) {
  EXPECT_EQ(drag_of({.left = true}), CameraDrag::orbit);
  EXPECT_EQ(drag_of({.middle = true}), CameraDrag::pan);
  EXPECT_EQ(drag_of({.left = true, .shift = true}), CameraDrag::pan);
  EXPECT_EQ(drag_of({.right = true}), CameraDrag::zoom);
  EXPECT_EQ(drag_of({.left = true, .ctrl = true}), CameraDrag::roll);
  EXPECT_EQ(drag_of({}), CameraDrag::none);
}

TEST(CameraControl, AnglesAndBackIsTheSameCamera) {
  std::mt19937 generator(7);
  for (int i = 0; i < 200; ++i) {
    const Camera camera = any_camera(generator);
    const Camera back = with_angles(camera, camera_angles(camera));
    EXPECT_LT((back.direction - camera.direction).norm(), 1e-9);
    EXPECT_LT((back.up - camera.up).norm(), 1e-9);
  }
  for (const std::string& name : camera_names()) {
    const Camera camera = standard_camera(name, {-70, -80, -90}, {70, 90, 120}, 1.3);
    const Camera back = with_angles(camera, camera_angles(camera));
    EXPECT_LT((back.direction - camera.direction).norm(), 1e-6) << name;
    EXPECT_LT((picture_axes(back) - picture_axes(camera)).norm(), 1e-6) << name;
    EXPECT_LT(std::abs(camera_angles(camera).roll), 1e-9) << name;
  }
}

TEST(CameraControl, OrbitKeepsTargetDistanceAndRoll) {
  std::mt19937 generator(11);
  std::uniform_real_distribution<double> pixel(-150, 150);
  for (int i = 0; i < 200; ++i) {
    const Camera before = any_camera(generator);
    const Vector2d from(600, 300), to = from + Vector2d(pixel(generator), pixel(generator));
    const Camera after = dragged(before, CameraDrag::orbit, from, to, window_view, limits);
    EXPECT_EQ(after.distance_mm, before.distance_mm);
    EXPECT_EQ(after.target, before.target);
    EXPECT_NEAR(after.direction.norm(), 1, 1e-12);
    EXPECT_NEAR(after.up.norm(), 1, 1e-12);
    EXPECT_NEAR(after.up.dot(after.direction), 0, 1e-12);
    if (std::abs(camera_angles(after).elevation) < 1.5) {
      EXPECT_NEAR(std::remainder(camera_angles(after).roll - camera_angles(before).roll, 2 * pi), 0,
                  1e-9);
    }
    EXPECT_GT((after.direction - before.direction).norm(), 1e-4);
  }
}

TEST(CameraControl, UprightPictureStaysUpright) {
  Camera camera = with_angles({}, {.azimuth = 0.3, .elevation = 0.2});
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> pixel(-90, 90);
  for (int i = 0; i < 300; ++i) {
    const Vector2d from(500, 200), to = from + Vector2d(pixel(generator), pixel(generator));
    camera = dragged(camera, CameraDrag::orbit, from, to, window_view, limits);
    // The patient's left-right axis never tilts: the picture's right is level.
    EXPECT_NEAR(picture_axes(camera)(0, 2), 0, 1e-9);
    EXPECT_GE(camera.up.z(), -1e-9);
  }
}

TEST(CameraControl, SurfaceFollowsTheMouseInOrbit) {
  std::mt19937 generator(5);
  int compared = 0;
  for (int i = 0; i < 200; ++i) {
    Camera before = any_camera(generator);
    CameraAngles angles = camera_angles(before);
    angles.elevation *= 0.3;  // near the poles the turn about the vertical is seen as a roll
    before = with_angles(before, angles);
    const Vector3d nearest = before.target + 60 * before.direction;
    for (const Vector2d& move : {Vector2d(9, 0), Vector2d(0, 9), Vector2d(-6, 7)}) {
      const Camera after = dragged(before, CameraDrag::orbit, {600, 300}, Vector2d(600, 300) + move,
                                   window_view, limits);
      const Vector2d moved = pixel_of(after, nearest) - pixel_of(before, nearest);
      EXPECT_GT(moved.normalized().dot(move.normalized()), 0.9);
      ++compared;
    }
  }
  EXPECT_EQ(compared, 600);
}

TEST(CameraControl, OrbitStopsAtThePoles) {
  Camera camera = with_angles({}, {.azimuth = 1});
  for (int i = 0; i < 20; ++i)
    camera = dragged(camera, CameraDrag::orbit, {600, 100}, {600, 250}, window_view, limits);
  EXPECT_NEAR(camera.direction.z(), 1, 1e-9);
  // And comes down again on the side it moved up.
  camera = dragged(camera, CameraDrag::orbit, {600, 250}, {600, 100}, window_view, limits);
  EXPECT_NEAR(camera_angles(camera).azimuth, 1, 1e-6);
}

TEST(CameraControl, PanKeepsThePointUnderTheMouse) {
  std::mt19937 generator(13);
  for (int i = 0; i < 100; ++i) {
    const Camera before = any_camera(generator);
    const Camera after =
        dragged(before, CameraDrag::pan, {400, 300}, {437, 279}, window_view, limits);
    // In the plane of the picture, and exactly as far as the mouse moved.
    EXPECT_NEAR((after.target - before.target).dot(before.direction), 0, 1e-9);
    EXPECT_EQ(after.distance_mm, before.distance_mm);
    EXPECT_EQ(after.direction, before.direction);
    const Vector2d moved = pixel_of(after, before.target) - pixel_of(before, before.target);
    EXPECT_NEAR((moved - Vector2d(37, -21)).norm(), 0, 0.01);
  }
}

TEST(CameraControl, ZoomIsBoundedAndChangesOnlyTheDistance) {
  std::mt19937 generator(17);
  const Camera before = any_camera(generator);
  const Camera nearer =
      dragged(before, CameraDrag::zoom, {400, 300}, {400, 250}, window_view, limits);
  EXPECT_LT(nearer.distance_mm, before.distance_mm);
  EXPECT_EQ(nearer.target, before.target);
  EXPECT_EQ(nearer.direction, before.direction);
  Camera camera = before;
  for (int i = 0; i < 100; ++i)
    camera = dragged(camera, CameraDrag::zoom, {400, 300}, {400, 0}, window_view, limits);
  EXPECT_EQ(camera.distance_mm, limits.nearest_mm);
  for (int i = 0; i < 100; ++i) camera = wheeled(camera, -3, {400, 300}, window_view, limits);
  EXPECT_EQ(camera.distance_mm, limits.farthest_mm);
}

TEST(CameraControl, WheelKeepsThePointUnderTheMouse) {
  std::mt19937 generator(19);
  for (int i = 0; i < 100; ++i) {
    const Camera before = any_camera(generator);
    const Vector2d mouse(333, 222);
    const Eigen::Matrix3d axes = picture_axes(before);
    const Vector2d offset = mouse - Vector2d(window_view.x + window_view.width / 2,
                                             window_view.y + window_view.height / 2);
    const Vector3d under =
        before.target + pixel_mm(before, window_view) *
                            (offset.x() * axes.row(0) - offset.y() * axes.row(1)).transpose();
    EXPECT_NEAR((pixel_of(before, under) - mouse).norm(), 0, 0.01);
    const Camera after = wheeled(before, 2, mouse, window_view, limits);
    EXPECT_LT(after.distance_mm, before.distance_mm);
    EXPECT_NEAR((pixel_of(after, under) - mouse).norm(), 0, 0.01);
  }
}

TEST(CameraControl, RollTurnsThePictureWithTheMouse) {
  std::mt19937 generator(23);
  const Vector2d centre(window_view.x + window_view.width / 2,
                        window_view.y + window_view.height / 2);
  for (int i = 0; i < 100; ++i) {
    const Camera before = any_camera(generator);
    // A quarter of a turn from the right of the centre to below it: clockwise.
    const Camera after = dragged(before, CameraDrag::roll, centre + Vector2d(100, 0),
                                 centre + Vector2d(0, 100), window_view, limits);
    EXPECT_LT((after.direction - before.direction).norm(), 1e-6);
    EXPECT_EQ(after.distance_mm, before.distance_mm);
    const Vector3d right_before = picture_axes(before).row(0);
    const Vector3d point = before.target + 50 * right_before;
    const Vector2d now = pixel_of(after, point) - centre;
    EXPECT_NEAR(now.x(), 0, 0.05);
    EXPECT_GT(now.y(), 10);
  }
}

}  // namespace
}  // namespace condyle
