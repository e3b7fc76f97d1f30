#include "sim/muscles/muscle_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace condyle {
namespace {

Muscle masseter() {
  Muscle m;
  m.max_force_N = 190.4;
  m.optimal_length_mm = 50;
  m.max_length_mm = 65;
  m.tendon_ratio = 0.4;
  m.passive_fraction = 0.015;
  return m;
}

TEST(MuscleLaw, PeckIsACosineOfTheFibreAndALineOfTheWhole) {
  const Muscle m = masseter();
  const MuscleLawSettings peck{.law = MuscleLaw::peck, .damping_N_s_mm = 0};
  EXPECT_NEAR(muscle_tension(m, peck, 1, 50, 0).active_N, 190.4, 1e-9);
  EXPECT_NEAR(muscle_tension(m, peck, 1, 35, 0).active_N, 0, 1e-9);  // half the fibre
  EXPECT_NEAR(muscle_tension(m, peck, 1, 65, 0).active_N, 0, 1e-9);  // half as much again
  EXPECT_NEAR(muscle_tension(m, peck, 1, 42.5, 0).active_N, 95.2, 1e-9);
  EXPECT_EQ(muscle_tension(m, peck, 1, 20, 0).active_N, 0);
  EXPECT_EQ(muscle_tension(m, peck, 1, 80, 0).active_N, 0);
  // No effect of speed but that of the damper.
  EXPECT_EQ(muscle_tension(m, peck, 1, 45, 300).at(1), muscle_tension(m, peck, 1, 45, -300).at(1));
  const MuscleLawSettings damped{.law = MuscleLaw::peck, .damping_N_s_mm = 0.002};
  EXPECT_NEAR(
      muscle_tension(m, damped, 1, 45, 100).at(0.5) - muscle_tension(m, peck, 1, 45, 100).at(0.5),
      0.2, 1e-12);
}

TEST(MuscleLaw, PassiveForceGrowsToItsFractionAtTheLongest) {
  const Muscle m = masseter();
  for (const MuscleLaw law : {MuscleLaw::peck, MuscleLaw::hill}) {
    const MuscleLawSettings s{.law = law, .damping_N_s_mm = 0};
    EXPECT_EQ(muscle_tension(m, s, 0, 49, 0).at(0), 0);
    EXPECT_NEAR(muscle_tension(m, s, 0, 57.5, 0).at(0), 0.5 * 0.015 * 190.4, 1e-9);
    EXPECT_NEAR(muscle_tension(m, s, 0, 90, 0).at(0), 0.015 * 190.4, 1e-9);
  }
}

TEST(MuscleLaw, HillFallsWithShorteningToNothingAndRisesWithLengthening) {
  const Muscle m = masseter();
  const MuscleLawSettings hill{.damping_N_s_mm = 0};
  const double isometric = muscle_tension(m, hill, 1, 50, 0).at(1);
  EXPECT_NEAR(isometric, 190.4, 1e-9);
  const double fastest = 10 * 30;  // fibre lengths a second
  EXPECT_EQ(muscle_tension(m, hill, 1, 50, -fastest).at(1), 0);
  EXPECT_EQ(muscle_tension(m, hill, 1, 50, -2 * fastest).at(1), 0);
  double before = 0;
  for (double v = -fastest; v <= 4 * fastest; v += 5) {
    const double now = muscle_tension(m, hill, 1, 50, v).at(1);
    EXPECT_GE(now, before);
    EXPECT_LE(now, 1.4 * isometric);
    before = now;
  }
  EXPECT_GT(before, 1.35 * isometric);
}

TEST(MuscleLaw, SlopeIsTheDerivativeBySpeed) {
  const Muscle m = masseter();
  int steep = 0;
  for (const MuscleLaw law : {MuscleLaw::peck, MuscleLaw::hill})
    for (const double v : {-250.0, -100.0, -3.0, 4.0, 120.0, 700.0}) {
      const MuscleLawSettings s{.law = law};
      const double a = 0.3, h = 1e-3, length = 47;
      const auto sum = [&](double speed) {
        const MuscleTension t = muscle_tension(m, s, a, length, speed);
        return a * t.active_N + t.passive_N;
      };
      const double slope = muscle_tension(m, s, a, length, v).slope_N_s_mm;
      EXPECT_NEAR(slope, (sum(v + h) - sum(v - h)) / (2 * h), 1e-6) << v;
      steep += slope > 0.05;
    }
  EXPECT_GT(steep, 0);
}

TEST(MuscleLaw, ActivationLagsUnderHillOnly) {
  const MuscleLawSettings hill, peck{.law = MuscleLaw::peck};
  EXPECT_EQ(next_activation(peck, 0, 0.7, 0.001), 0.7);
  double up = 0, down = 1;
  for (int k = 0; k < 15; ++k) up = next_activation(hill, up, 1, 0.001);
  for (int k = 0; k < 50; ++k) down = next_activation(hill, down, 0, 0.001);
  EXPECT_NEAR(up, 1 - std::exp(-1), 1e-12);  // one time constant each
  EXPECT_NEAR(down, std::exp(-1), 1e-12);
}

}  // namespace
}  // namespace condyle
