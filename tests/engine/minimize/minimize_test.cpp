#include "engine/minimize/minimize.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "tests/support/allocated.h"
#include "tools/bench/baseline/baseline_minimizers.h"
#include "tools/bench/baseline/line_search.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// A chain of points: stiff springs of length one from each to the next, the ends pulled apart and
/// up; infinite below the floor z = -1. Samples the memory in use at each evaluation.
class Chain final : public Objective {
 public:
  double value(const Points& x) override {
    Points unused;
    return value_and_gradient(x, unused);
  }
  double value_and_gradient(const Points& x, Points& gradient) override {
    max_memory = std::max(max_memory, allocated_bytes());
    gradient.assign(x.size(), Vector3d::Zero());
    double sum = 0;
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      const Vector3d d = x[i + 1] - x[i];
      const double l = d.norm(), k = 1 + static_cast<double>(i);
      sum += k * (l - 1) * (l - 1);
      gradient[i] -= 2 * k * (l - 1) / l * d;
      gradient[i + 1] += 2 * k * (l - 1) / l * d;
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (x[i].z() < floor) return std::numeric_limits<double>::infinity();
      const Vector3d d = x[i] - target(i);
      sum += 0.05 * d.squaredNorm();
      gradient[i] += 0.1 * d;
    }
    return sum;
  }
  Curvature curvature(const Points& x, const Points& d) override {
    ++line_evaluations;
    Points up = x, down = x, g_up, g_down;
    double sum = 0, size = 0;
    for (const auto& v : d) size = std::max(size, v.norm());
    const double h = 1e-6 / size;
    for (std::size_t i = 0; i < x.size(); ++i) {
      up[i] += h * d[i];
      down[i] -= h * d[i];
    }
    value_and_gradient(up, g_up);
    value_and_gradient(down, g_down);
    for (std::size_t i = 0; i < x.size(); ++i) sum += d[i].dot(g_up[i] - g_down[i]) / (2 * h);
    return {sum, std::abs(sum)};
  }
  static Vector3d target(std::size_t i) {
    const double s = static_cast<double>(i);
    return {1.3 * s, std::sin(s), 0.2 * s};
  }

  double floor = -1;
  int line_evaluations = 0;  // along line searches
  std::size_t max_memory = 0;
};

class Unit : public Preconditioner {
 public:
  explicit Unit(double stiffness = 1) : stiffness_(stiffness) {}
  void solve(const Points& g, Points& z) const override {
    z = g;
    for (auto& p : z) p /= stiffness_;
  }
  std::size_t bytes() const override { return 0; }

 private:
  double stiffness_;
};

Points straight_chain(std::size_t n) {
  Points x;
  for (std::size_t i = 0; i < n; ++i) x.emplace_back(0.9 * static_cast<double>(i), 0.1, 0);
  return x;
}

BaselineSettings tight() {
  BaselineSettings settings;
  settings.tolerance_mm = 1e-8;
  settings.line_tolerance = 1e-3;
  settings.max_iterations = 20000;
  return settings;
}

class EachMethod : public testing::TestWithParam<MethodFacts> {};

TEST_P(EachMethod, FindsTheSameMinimum) {
  Chain chain;
  const Unit unit;
  Points expected = straight_chain(12), x = expected;
  ASSERT_TRUE(minimize_with(Method::quasi_newton, chain, tight(), expected).converged());
  const double start = chain.value(x);
  const auto result = minimize_with(GetParam().method, chain, tight(), x, &unit);
  EXPECT_TRUE(result.converged());
  EXPECT_LT(result.energy, 0.9 * start);
  EXPECT_EQ(result.energy, chain.value(x));
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT((x[i] - expected[i]).norm(), 1e-4);
}

TEST_P(EachMethod, ABudgetLeavesTheBestSoFarAndReportsTheResidual) {
  Chain chain;
  const Unit unit;
  for (int evaluations : {1, 7, 40}) {
    BaselineSettings settings = tight();
    settings.max_evaluations = evaluations;
    Points x = straight_chain(12), gradient;
    const double start = chain.value(x);
    const auto result = minimize_with(GetParam().method, chain, settings, x, &unit);
    EXPECT_EQ(result.status, MinimizeResult::Status::budget_spent);
    EXPECT_LE(result.evaluations, evaluations + 3);  // that in hand is completed
    EXPECT_LE(chain.value_and_gradient(x, gradient), start);
    double largest = 0;
    for (const auto& g : gradient) largest = std::max(largest, g.norm());
    EXPECT_DOUBLE_EQ(result.residual, largest);
    EXPECT_GT(largest, 0);
  }
}

TEST_P(EachMethod, NeverStepsWhereTheValueIsInfinite) {
  Chain chain;
  const Unit unit;
  chain.floor = -0.01;  // the path down to y < 0 passes close to it
  Points x = straight_chain(8);
  for (auto& p : x) p.z() = 0.5;
  const auto result = minimize_with(GetParam().method, chain, tight(), x, &unit);
  EXPECT_TRUE(std::isfinite(result.energy));
  for (const auto& p : x) EXPECT_GE(p.z(), chain.floor);
}

TEST_P(EachMethod, ABadStartMovesNothing) {
  Chain chain;
  const Unit unit;
  Points x = straight_chain(5);
  x[2].z() = -5;
  const Points before = x;
  const auto result = minimize_with(GetParam().method, chain, {}, x, &unit);
  EXPECT_EQ(result.status, MinimizeResult::Status::bad_start);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(x[i], before[i]);
}

TEST_P(EachMethod, TheMemoryReportedIsThatAllocated) {
  Chain chain;
  const Unit unit;
  MinimizeSettings settings;
  settings.max_evaluations = 60;
  Points x = straight_chain(200), warm_up = x;
  minimize_with(GetParam().method, chain, settings, warm_up, &unit);
  chain.max_memory = 0;
  const std::size_t before = allocated_bytes();
  const auto result = minimize_with(GetParam().method, chain, settings, x, &unit);
  const double grown = static_cast<double>(chain.max_memory) - static_cast<double>(before);
  ASSERT_GT(grown, 0);
  // The chain's own curvature and value use up to four vectors of points besides.
  EXPECT_GE(grown, 0.95 * static_cast<double>(result.bytes) - 4800);
  EXPECT_LE(grown, 1.05 * static_cast<double>(result.bytes) + 4.5 * 4800);
}

TEST_P(EachMethod, RepeatsToTheBit) {
  Chain chain;
  const Unit unit;
  Points a = straight_chain(9), b = a;
  minimize_with(GetParam().method, chain, {}, a, &unit);
  minimize_with(GetParam().method, chain, {}, b, &unit);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i], b[i]);
}

TEST(Preconditioned, IsNotAtTheMinimumBecauseThePreconditionerIsTooStiff) {
  Chain chain;
  Points expected = straight_chain(12);
  ASSERT_TRUE(minimize_with(Method::quasi_newton, chain, tight(), expected).converged());
  MinimizeSettings settings;
  for (double stiffness : {1.0, 50.0, 1000.0}) {
    const Unit unit(stiffness);
    Points x = expected;
    for (auto& p : x) p.z() += 5 * settings.tolerance_mm;  // pulled back by 0.1 a point
    EXPECT_TRUE(minimize(chain, unit, settings, x).converged());
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_LT((x[i] - expected[i]).norm(), settings.tolerance_mm) << stiffness;
  }
}

TEST(Preconditioned, SearchesALineOnlyWhereNecessary) {
  Chain chain;
  Points expected = straight_chain(12);
  ASSERT_TRUE(minimize_with(Method::quasi_newton, chain, tight(), expected).converged());
  constexpr double pull = 0.1;  // of a point that the whole chain has left its line by
  MinimizeSettings settings;
  for (double too_stiff : {1.0, 2.0, 4.0})
    for (bool fresh : {false, true}) {
      const Unit unit(pull * too_stiff);
      Points x = expected;
      for (auto& p : x) p.z() += 5 * settings.tolerance_mm;
      settings.fresh = fresh;
      chain.line_evaluations = 0;
      EXPECT_TRUE(minimize(chain, unit, settings, x).converged());
      for (std::size_t i = 0; i < x.size(); ++i)
        EXPECT_LT((x[i] - expected[i]).norm(), settings.tolerance_mm) << too_stiff << fresh;
      EXPECT_EQ(chain.line_evaluations == 0, fresh) << too_stiff;
    }
}

INSTANTIATE_TEST_SUITE_P(Minimize, EachMethod,
                         testing::ValuesIn(all_methods().begin(), all_methods().end()),
                         [](const auto& method) { return std::string(method.param.name); });

TEST(LineSearch, BothFindTheMinimumOfACurveFromAnyFirstStep) {
  const auto value = [](double t) { return std::pow(t - 2, 4) + 0.5 * (t - 2) * (t - 2) + 3; };
  const auto slope = [](double t) { return 4 * std::pow(t - 2, 3) + (t - 2); };
  for (double first : {1e-4, 0.3, 2.0, 50.0, 1e4}) {
    LineSettings settings;
    settings.first_step = first;
    settings.tolerance = 1e-5;
    const LinePoint start{0, value(0), slope(0)};
    const LinePoint a = search_by_parabolas(value, start, settings);
    const LinePoint b = search_by_slopes(
        [&](double t) {
          return LinePoint{t, value(t), slope(t)};
        },
        start, settings);
    EXPECT_NEAR(a.t, 2, 1e-3) << first;
    EXPECT_NEAR(b.t, 2, 1e-3) << first;
  }
}

TEST(Minimize, APreconditionerIsRenewedDuringTheSolve) {
  Chain chain;
  const Unit unit, stiffer(2);
  Points expected = straight_chain(12), x = expected;
  ASSERT_TRUE(minimize_with(Method::quasi_newton, chain, tight(), expected).converged());
  BaselineSettings settings = tight();
  std::vector<int> asked;
  settings.renew = [&](const Points& now, const MinimizeResult& done) -> const Preconditioner* {
    asked.push_back(done.iterations);
    EXPECT_EQ(now.size(), x.size());
    return done.iterations == 3 ? &stiffer : nullptr;
  };
  const auto result = minimize(chain, unit, settings, x);
  EXPECT_TRUE(result.converged());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_LT((x[i] - expected[i]).norm(), 1e-4);
  ASSERT_EQ(asked.size(), static_cast<std::size_t>(result.iterations));
  for (std::size_t i = 0; i < asked.size(); ++i) EXPECT_EQ(asked[i], static_cast<int>(i) + 1);
}

/// Counts its solves.
class Counting final : public Unit {
 public:
  void solve(const Points& g, Points& z) const override {
    ++solves;
    Unit::solve(g, z);
  }
  mutable int solves = 0;
};

TEST(Minimize, WithoutTheLastCheckASolveIsSavedAndTheResultIsTheSame) {
  Chain chain;
  MinimizeSettings settings;
  settings.max_iterations = 4;
  const Counting with, without;
  Points a = straight_chain(12), b = a;
  const auto checked = minimize(chain, with, settings, a);
  settings.check_last = false;
  const auto unchecked = minimize(chain, without, settings, b);
  EXPECT_EQ(with.solves, without.solves + 1);
  EXPECT_EQ(checked.iterations, 4);
  EXPECT_EQ(unchecked.iterations, 4);
  EXPECT_EQ(unchecked.status, MinimizeResult::Status::budget_spent);
  EXPECT_EQ(a, b);
  EXPECT_EQ(checked.energy, unchecked.energy);
  EXPECT_EQ(checked.residual, unchecked.residual);
}

TEST(Minimize, AFailedRenewalEndsWithTheBestPointReached) {
  Chain chain;
  const Unit unit, none(0);
  Points x = straight_chain(12);
  const double start = chain.value(x);
  BaselineSettings settings = tight();
  settings.renew = [&](const Points&, const MinimizeResult& done) -> const Preconditioner* {
    return done.iterations == 3 ? &none : nullptr;
  };
  const auto result = minimize(chain, unit, settings, x);
  EXPECT_EQ(result.status, MinimizeResult::Status::stalled);
  EXPECT_EQ(result.iterations, 3);
  EXPECT_LT(result.energy, start);
  EXPECT_EQ(result.energy, chain.value(x));
}

TEST(LineSearch, ParabolasSearchBothSidesAndTurnBackBeforeAWall) {
  LineSettings settings;
  settings.both_sides = true;
  settings.tolerance = 1e-4;
  const auto left = [](double t) { return (t + 3) * (t + 3); };
  EXPECT_NEAR(search_by_parabolas(left, {0, left(0), 0}, settings).t, -3, 1e-3);
  const auto wall = [](double t) {
    return t > 0.5 ? std::numeric_limits<double>::infinity() : (t - 0.4) * (t - 0.4);
  };
  settings.both_sides = false;
  EXPECT_NEAR(search_by_parabolas(wall, {0, wall(0), -0.8}, settings).t, 0.4, 1e-3);
}

}  // namespace
}  // namespace condyle
