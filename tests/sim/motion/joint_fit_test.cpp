#include "sim/motion/joint_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "engine/core/units.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

struct Truth {
  double inclination[2], bennett[2], shift[2];  // left, right; deg, mm
  double hinge_deg, deg_per_mm;
};

Case jaw() {
  Case patient;
  patient.landmarks.points = {{"left_condyle", {50, 0, 0}},
                              {"right_condyle", {-50, 0, 0}},
                              {"lower_incisal_point", {0, -80, -40}}};
  return patient;
}

/// The pose of opening rotation and condylar travels, condyles 100 mm apart: the orbiting one on
/// its path, the other at the same height and depth and as far aside as the bone makes it.
Pose pose(const Truth& truth, double turn_deg, double left_mm, double right_mm) {
  const int orbiting = left_mm >= right_mm ? 0 : 1;
  const double forward[2] = {left_mm, right_mm};
  Vector3d at[2];
  for (int side = 0; side < 2; ++side)
    at[side] = {0, -forward[side], -forward[side] * std::tan(truth.inclination[side] * degree)};
  const double f = forward[orbiting];
  // Only where the sides part: straight opening is symmetric.
  const double aside = std::abs(left_mm - right_mm) < 1e-9
                           ? 0
                           : truth.shift[orbiting] * (1 - std::exp(-f)) +
                                 f * std::tan(truth.bennett[orbiting] * degree);
  const double inward = orbiting == 0 ? -1 : 1, outward = orbiting == 0 ? 50 : -50;
  at[orbiting].x() = outward + inward * aside;
  const Vector3d between = at[1 - orbiting] - at[orbiting];
  at[1 - orbiting].x() =
      at[orbiting].x() +
      inward * std::sqrt(100 * 100 - between.y() * between.y() - between.z() * between.z());
  const Vector3d axis = (at[0] - at[1]).normalized();
  Pose X;
  X.R = Eigen::AngleAxisd(turn_deg * degree, axis) *
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), axis);
  X.t = 0.5 * (at[0] + at[1]);
  return X;
}

/// Opens, then moves to either side, recorded by markers with noise.
Motion recording(const Truth& truth, double noise_mm) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal(0, noise_mm);
  auto poses = std::make_shared<std::vector<Pose>>();
  const auto bump = [](double u) { return 0.5 * (1 - std::cos(2 * std::numbers::pi * u)); };
  for (int k = 0; k < 200; ++k) {
    const double turn = 30 * bump(k / 200.0);
    const double forward = std::max(0.0, turn - truth.hinge_deg) / truth.deg_per_mm;
    poses->push_back(pose(truth, turn, forward, forward));
  }
  for (int k = 0; k < 200; ++k) poses->push_back(pose(truth, 2, 9 * bump(k / 200.0), 0));
  for (int k = 0; k < 200; ++k) poses->push_back(pose(truth, 2, 0, 9 * bump(k / 200.0)));
  Motion motion;
  motion.recorded = true;
  for (Pose& X : *poses) {
    // Noise of three markers on the teeth and the condyles' line, as a small pose.
    for (int a = 0; a < 3; ++a) X.t[a] += normal(random);
    const Vector3d turn(normal(random) / 50, normal(random) / 50, normal(random) / 50);
    X.R = Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * X.R;
    motion.sample_times.push_back(0.01 * static_cast<double>(motion.sample_times.size()));
  }
  motion.duration_s = motion.sample_times.back();
  motion.target = [poses](double t) {
    return (*poses)[static_cast<std::size_t>(std::lround(t / 0.01))];
  };
  return motion;
}

TEST(JointFit, RecoversTheParametersOfASyntheticRecording) {
  const Truth truth{{42, 33}, {8, 14}, {0.3, 0.8}, 12, 1.5};
  for (const double noise : {0.0, 0.1}) {
    const auto fit = fit_joint(jaw(), recording(truth, noise));
    ASSERT_TRUE(fit);
    const JointFit::Side* sides[2] = {&fit->left, &fit->right};
    for (int side = 0; side < 2; ++side) {
      ASSERT_TRUE(sides[side]->inclination_deg && sides[side]->bennett_deg);
      EXPECT_NEAR(*sides[side]->inclination_deg, truth.inclination[side], 2) << side << noise;
      EXPECT_NEAR(*sides[side]->bennett_deg, truth.bennett[side], 2) << side << noise;
      EXPECT_NEAR(*sides[side]->side_shift_mm, truth.shift[side], 1) << side << noise;
      EXPECT_NEAR(sides[side]->travel_mm, 12, 1);
    }
    ASSERT_TRUE(fit->hinge_deg);
    EXPECT_NEAR(*fit->hinge_deg, truth.hinge_deg, 2) << noise;
    EXPECT_NEAR(*fit->deg_per_mm, truth.deg_per_mm, 0.15) << noise;
    EXPECT_EQ(describe(*fit).size(), 4u);
  }
}

TEST(JointFit, ReportsOnlyWhatTheMotionShows) {
  Motion still;
  still.duration_s = 1;
  still.target = [](double) { return Pose{}; };
  const auto fit = fit_joint(jaw(), still);
  ASSERT_TRUE(fit);
  EXPECT_FALSE(fit->left.inclination_deg || fit->right.bennett_deg || fit->hinge_deg);
  EXPECT_TRUE(describe(*fit).empty());
  EXPECT_FALSE(fit_joint({}, still));
}

TEST(JointFit, CountsFromTheFrankfortPlane) {
  const Truth truth{{40, 40}, {8, 8}, {0.3, 0.3}, 12, 1.5};
  Case patient = jaw();
  // Orbitale 10 degrees above porion: the plane rises to the front, the path falls more steeply.
  patient.landmarks.points["left_porion"] = {60, 0, 10};
  patient.landmarks.points["left_orbitale"] = {30, -80, 10 + 80 * std::tan(10 * degree)};
  const auto fit = fit_joint(patient, recording(truth, 0));
  ASSERT_TRUE(fit && fit->to_frankfort);
  EXPECT_NEAR(*fit->left.inclination_deg, 50, 1);
}

}  // namespace
}  // namespace condyle
