#include "sim/occlusion/elastic_layer.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "engine/math/pose.h"
#include "tests/support/shapes.h"

namespace condyle::test {
namespace {

const Eigen::Vector3d pivot(1, 2, 3);
constexpr double rotation_length_mm = 7;

/// A ball with its surface and field.
struct Bumpy {
  explicit Bumpy(double radius)
      : mesh(sphere(4, radius, {0, 0, 0}, 0.02)),
        surface(make_layer_surface(mesh, bounding_box(mesh), 0.3)),
        field(mesh, {.spacing_mm = 0.4, .band_mm = 1.5, .region = {}}) {}
  TriMesh mesh;
  LayerSurface surface;
  DistanceField field;
};

const Bumpy& large() {
  static const Bumpy ball(8);
  return ball;
}
const Bumpy& small() {
  static const Bumpy ball(6);
  return ball;
}

Pose turned(Pose pose, const Twist& x) {
  const Eigen::Vector3d center = pose * pivot, turn = x.tail<3>() / rotation_length_mm;
  const Eigen::Quaterniond R(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  pose.t = center + x.head<3>() - R * (pose.R * pivot);
  pose.R = (R * pose.R).normalized();
  return pose;
}

}  // namespace

TEST(ElasticLayer, PressureIsMinusTheSlopeOfItsEnergyAndStiffnessThatOfThePressure) {
  const ElasticLayer layer{.thickness_mm = 0.1, .stiffness_MPa = 30};
  for (const double gap : {-0.4, -0.01, 0.001, 0.004, 0.0051, 0.02, 0.07, 0.0999}) {
    const double d = 1e-7;
    const auto low = layer.at(gap - d), here = layer.at(gap), high = layer.at(gap + d);
    EXPECT_NEAR(here.pressure, -(high.energy - low.energy) / (2 * d), 1e-4 * here.pressure + 1e-3);
    EXPECT_NEAR(here.stiffness, -(high.pressure - low.pressure) / (2 * d), 1e-3 * here.stiffness);
    EXPECT_GT(here.pressure, 0);
    EXPECT_GT(low.pressure, here.pressure);
  }
  EXPECT_NEAR(layer.at(0.05).pressure, 30, 1e-12);
  EXPECT_EQ(layer.at(0.1).pressure, 0);
  EXPECT_EQ(layer.at(2).energy, 0);
}

TEST(LayerSurface, PiecesHaveTheSurfacesArea) {
  const TriMesh mesh = sphere(4, 10);
  const auto surface = make_layer_surface(mesh, bounding_box(mesh), 0.4);
  double area = 0;
  for (const auto& piece : surface.pieces) area += piece.area_mm2;
  EXPECT_NEAR(area, surface_area(mesh), 1e-9 * area);
  int leaves = 0;
  for (const auto& ball : surface.balls) {
    leaves += ball.right == 0 ? ball.count : 0;
    for (int i = ball.first; i < ball.first + ball.count; ++i)
      ASSERT_LE((surface.pieces[i].point - ball.center).norm(), ball.radius + 1e-9);
  }
  EXPECT_EQ(leaves, static_cast<int>(surface.pieces.size()));
}

TEST(LayerContact, GradientIsTheCentralDifferenceOfTheEnergy) {
  const Bumpy &fixed = large(), &moving = small();
  // Thick, and deep in contact, so that many cells of the field are crossed.
  const LayerContact layer({&fixed.surface, &fixed.field}, {&moving.surface, &moving.field},
                           {.thickness_mm = 1, .stiffness_MPa = 5});
  Pose pose;
  pose.R = Eigen::Quaterniond(0.8, 0.3, -0.2, 0.4).normalized();
  pose.t = Eigen::Vector3d(6, 9, 8).normalized() * 14.3;
  const auto here = layer.evaluate(pose, pivot, rotation_length_mm);
  ASSERT_GT(here.area_mm2, 5);
  ASSERT_GT(here.gradient.norm(), 1);
  for (int k = 0; k < 6; ++k) {
    const double d = 1e-4;
    const double
        high = layer.evaluate(turned(pose, d * Twist::Unit(k)), pivot, rotation_length_mm).energy,
        low = layer.evaluate(turned(pose, -d * Twist::Unit(k)), pivot, rotation_length_mm).energy;
    EXPECT_NEAR(here.gradient[k], (high - low) / (2 * d), 0.01 * here.gradient.norm()) << k;
  }
}

TEST(LayerContact, EnergyIsTheSameWhicheverBodyMoves) {
  const Bumpy &a = large(), &b = small();
  const ElasticLayer layer{.thickness_mm = 0.5, .stiffness_MPa = 5};
  Pose pose;
  pose.R = Eigen::Quaterniond(0.5, 0.3, -0.7, 0.4).normalized();
  pose.t = Eigen::Vector3d(-6, 3, 8).normalized() * 14.1;
  const auto one = LayerContact({&a.surface, &a.field}, {&b.surface, &b.field}, layer)
                       .evaluate(pose, pivot, rotation_length_mm);
  const auto other = LayerContact({&b.surface, &b.field}, {&a.surface, &a.field}, layer)
                         .evaluate(pose.inverse(), pivot, rotation_length_mm);
  ASSERT_GT(one.energy, 0);
  EXPECT_NEAR(one.energy, other.energy, 1e-9 * one.energy);
  EXPECT_NEAR(one.area_mm2, other.area_mm2, 1e-9);
}

TEST(LayerContact, IsBitIdenticalForOneAndTwoThreads) {
  const Bumpy &a = large(), &b = small();
  const LayerContact layer({&a.surface, &a.field}, {&b.surface, &b.field},
                           {.thickness_mm = 0.5, .stiffness_MPa = 5});
  Pose pose;
  pose.t = {3, 2, 13.5};
  const auto one = layer.evaluate(pose, pivot, rotation_length_mm, 1),
             two = layer.evaluate(pose, pivot, rotation_length_mm, 2);
  ASSERT_GT(one.energy, 0);
  EXPECT_EQ(one.energy, two.energy);
  EXPECT_EQ(one.gradient, two.gradient);
  EXPECT_EQ(one.hessian, two.hessian);
}

TEST(LayerContact, IsFreeOnlyOutsideTheFilm) {
  const Bumpy &a = large(), &b = small();
  const LayerContact layer({&a.surface, &a.field}, {&b.surface, &b.field}, {.thickness_mm = 0.3});
  const auto at = [](double height) {
    Pose pose;
    pose.t = {0, 0, height};
    return pose;
  };
  EXPECT_TRUE(layer.free(at(16)));
  EXPECT_FALSE(layer.free(at(14)));
  EXPECT_FALSE(layer.free(at(5)));  // far inside, beyond the field's band
}

}  // namespace condyle::test
