// Chewing cycles in the shape of a tear drop: opening near the midline, closing from the working
// side, the last millimetre gliding on the teeth, then a pause in the bite.

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/core/error.h"
#include "sim/motion/movements.h"

namespace condyle {
namespace {

constexpr double default_rate_hz = 1.4, default_size_mm = 15, default_width_mm = 5;
constexpr int default_cycles = 5;
constexpr double pause_fraction = 0.16;  // of a cycle, spent in the bite
constexpr double min_early = 0.5;        // chewing condyles translate from the start

/// Lateral displacement over the width of the cycle, by the fraction of its moving phase: slightly
/// to the balancing side at first, widest during closing, still lateral when teeth meet.
Pchip aside_of_cycle() {
  constexpr std::array<double, 8> u = {0, 0.1, 0.25, 0.42, 0.68, 0.82, 0.92, 1};
  constexpr std::array<double, 8> aside = {0, -0.08, -0.1, 0.12, 0.9, 0.55, 0.18, 0};
  return {u, aside};
}

}  // namespace

/// Inputs that displace the incisal point downward and laterally from the bite.
JawInputs Movements::chewing_inputs(double opening_mm, double aside_mm,
                                    const JawInputs& guess) const {
  Coupling coupling = limits_.coupling;
  coupling.early = std::max(coupling.early, min_early);
  const auto inputs = [&](const Eigen::Vector2d& x) {
    const double forward = coupling.forward_mm(x[0]);
    // Towards the left, the right condyle moves forward.
    const double left = forward + std::max(-x[1], 0.0), right = forward + std::max(x[1], 0.0);
    return JawInputs{x[0], left, right, joints_->bennett_shift_mm(left, right)};
  };
  const Eigen::Vector3d start = joints_->closed_incisor();
  Eigen::Vector2d x(guess.theta, guess.right_mm - guess.left_mm);
  const auto missed = [&](const Eigen::Vector2d& at) {
    const Eigen::Vector3d d = joints_->incisor(inputs(at)) - start;
    return Eigen::Vector2d(-d.z() - opening_mm, d.x() - aside_mm);
  };
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector2d now = missed(x);
    if (now.norm() < 1e-7) break;
    Eigen::Matrix2d slope;
    constexpr double h = 1e-4;
    slope.col(0) = (missed(x + Eigen::Vector2d(h, 0)) - now) / h;
    slope.col(1) = (missed(x + Eigen::Vector2d(0, h)) - now) / h;
    Eigen::Vector2d step = -slope.fullPivLu().solve(now);
    step *= std::min(1.0, 2 / std::max(std::abs(step[1]), 20 * std::abs(step[0])));
    x += step;
  }
  return inputs(x);
}

void Movements::chew(bool to_left, const Statement& statement) {
  traces_borders_ = true;
  if (here_.theta != biting(0, 0).theta || here_.left_mm != 0 || here_.right_mm != 0) {
    begin("closing");
    close({});
  }
  begin(to_left ? "chewing left" : "chewing right");
  const int cycles = static_cast<int>(
      std::lround(statement.amount.value_or(parameters_.chew_cycles.value_or(default_cycles))));
  const double rate =
      statement.rate_hz.value_or(parameters_.chew_rate_hz.value_or(default_rate_hz));
  const double size =
      statement.size_mm.value_or(parameters_.chew_size_mm.value_or(default_size_mm));
  const double width =
      statement.width_mm.value_or(parameters_.chew_width_mm.value_or(default_width_mm));
  const double period = statement.duration_s ? *statement.duration_s / cycles : 1 / rate;
  if (const double max_mm = joints_->opening_mm(opened(limits_.widest_theta)); size > max_mm)
    throw InputError(fmt::format(
        "{}: a cycle height of {:.1f} mm exceeds the maximum opening of this jaw ({:.1f} mm)",
        statement.where, size, max_mm));

  // One cycle, sampled densely enough for smooth interpolation.
  constexpr int samples = 96;
  const Pchip aside = aside_of_cycle();
  const JawInputs bite = biting(0, 0);
  const double bite_opening = joints_->opening_mm(bite);
  std::array<std::vector<double>, 3> values;  // theta, left, right
  std::vector<double> at;
  JawInputs guess = bite;
  for (int i = 0; i <= samples; ++i) {
    const double u = static_cast<double>(i) / samples;
    const double down = 0.5 * size * (1 - std::cos(2 * std::numbers::pi * u));
    const double x = (to_left ? 1 : -1) * width * aside(u);
    guess = i == 0 || i == samples ? bite : chewing_inputs(bite_opening + down, x, guess);
    at.push_back(u);
    values[0].push_back(guess.theta);
    values[1].push_back(guess.left_mm);
    values[2].push_back(guess.right_mm);
  }
  const std::array<Pchip, 3> round = {Pchip(at, values[0]), Pchip(at, values[1]),
                                      Pchip(at, values[2])};
  Leg cycle = leg(
      [=, joints = joints_](double p) {
        const double left = round[1](p), right = round[2](p);
        return JawInputs{round[0](p), left, right, joints->bennett_shift_mm(left, right)};
      },
      false);
  cycle.eased = false;
  for (int i = 0; i < cycles; ++i) {
    append(cycle, {.duration_s = period * (1 - pause_fraction), .speed_mm_s = {}});
    here_ = bite;
    hold(period * pause_fraction);
  }
}

}  // namespace condyle
