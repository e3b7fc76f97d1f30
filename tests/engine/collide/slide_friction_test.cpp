#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "engine/collide/slide.h"
#include "tests/engine/collide/slide_bodies.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using test::body;
using test::plate;

Pose placed(const Vector3d& t) { return {Quaterniond::Identity(), t}; }

Pose turned(const Vector3d& axis, double degrees) {
  return {Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis)), Vector3d::Zero()};
}

/// Hardly rotates, so that a pull at the centre acts at the contacts.
SlideSettings rough(double friction) {
  SlideSettings settings;
  settings.friction = friction;
  settings.rotation_length_mm = 1000;
  return settings;
}

TEST(SlideFriction, AnInclineHoldsBelowTheFrictionAngleAndSlidesAboveIt) {
  for (const double friction : {0.2, 0.5}) {
    const double holds = std::atan(friction) * 180 / std::numbers::pi;
    for (const double degrees : {0.5 * holds, 0.9 * holds, 1.1 * holds, 1.5 * holds}) {
      const Pose lean = turned(Vector3d::UnitY(), degrees);
      const SlidingContact model({body(test::moved(plate(), lean))},
                                 {body(test::box({-3, -3, 0}, {3, 3, 4}))}, rough(friction));
      const Vector3d up = lean.R * Vector3d::UnitZ(), downhill = lean.R * Vector3d::UnitX();
      const Pose start{lean.R, 0.01 * up};
      const double pull = 1;  // straight down
      Pose target = start;
      target.t.z() -= pull;
      const SlideResult result = model.slide(start, target);
      const double angle = degrees * std::numbers::pi / 180;
      const double coulomb = std::max(0.0, pull * (std::sin(angle) - friction * std::cos(angle)));
      EXPECT_NEAR((result.X_FM.t - start.t).dot(downhill), coulomb, 0.03)
          << friction << " at " << degrees;
      EXPECT_NEAR((result.X_FM.t - start.t).y(), 0, 0.03);
      EXPECT_NEAR(result.X_FM.t.dot(up), 0, 0.03);
    }
  }
}

TEST(SlideFriction, AGrooveHoldsByFrictionOverTheSineOfItsHalfAngle) {
  const double friction = 0.25, press = 0.6;
  for (const double half : {45.0, 60.0}) {
    // Two plates that lean by 90 degrees less the half angle; the groove's bottom is the y axis.
    const double lean = 90 - half;
    const TriMesh left =
        test::moved(test::box({-1, -15, -3}, {14, 15, 0}), turned(Vector3d::UnitY(), -lean));
    const TriMesh right =
        test::moved(test::box({-14, -15, -3}, {1, 15, 0}), turned(Vector3d::UnitY(), lean));
    const SlidingContact model({body(left), body(right)}, {body(test::sphere(5, 5))},
                               rough(friction));
    const double sine = std::sin(half * std::numbers::pi / 180);
    const Vector3d rest(0, 0, 5 / sine);
    const Pose start = model.slide(placed(rest + 0.3 * Vector3d::UnitZ()), placed(rest)).X_FM;
    const double holds = friction * press / sine;
    for (const double fraction : {0.5, 0.85, 1.2, 2.0}) {
      const double along = fraction * holds;
      const SlideResult result = model.slide(start, placed(start.t + Vector3d(0, along, -press)));
      EXPECT_NEAR(result.X_FM.t.y() - start.t.y(), std::max(0.0, along - holds), 0.04)
          << half << " at " << fraction;
      EXPECT_NEAR(result.X_FM.t.x(), 0, 0.04);
      EXPECT_NEAR(result.X_FM.t.z(), rest.z(), 0.06);
    }
  }
}

/// Two bumpy balls, pressed together and pulled sideways.
TEST(SlideFriction, OnBumpsItNeitherTremblesNorCreepsWhileTheTargetRests) {
  const auto crown = body(test::sphere(4, 9, {0, 0, 0}, 0.05));
  const auto other = body(test::sphere(4, 5, {0, 0, 0}, 0.05));
  for (const double friction : {0.1, 0.3}) {
    SlideSettings settings;
    settings.friction = friction;
    const SlidingContact model({crown}, {other}, settings);
    for (const double sideways : {0.0, 0.1, 0.6}) {
      const Pose target = placed({0.5 + sideways, 0.3, 13.2});
      SlideCache memory;
      Pose X = model.slide(placed({0.5, 0.3, 16}), placed({0.5, 0.3, 13.2}), &memory).X_FM;
      X = model.slide(X, target, &memory).X_FM;
      const auto displacement = [](const Pose& a, const Pose& b) {
        return (a.t - b.t).norm() + 5 * rotation_angle(a.inverse() * b);
      };
      const Pose first = X;
      for (int frame = 0; frame < 100; ++frame) {
        const SlideResult result = model.slide(X, target, &memory);
        EXPECT_TRUE(result.touching);
        ASSERT_LE(displacement(result.X_FM, X), 0.02)
            << friction << ' ' << sideways << ' ' << frame;
        X = result.X_FM;
      }
      EXPECT_LE(displacement(X, first), 0.05) << friction << ' ' << sideways;
    }
  }
}

}  // namespace
}  // namespace condyle
