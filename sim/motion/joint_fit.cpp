#include "sim/motion/joint_fit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "sim/motion/condylar_path.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double secant_mm = 5;         // forward, over which an inclination is told
constexpr double path_shown_mm = 3;     // forward travel that shows a path
constexpr double path_used_mm = 8;      // of it
constexpr double orbits_by_mm = 1;      // farther forward than the other side
constexpr double together_mm = 1;       // both sides forward alike
constexpr double turned_least_deg = 5;  // that shows a hinge
constexpr double shift_length_mm = 1;   // over which the immediate side shift happens
constexpr int least_rows = 8;

struct Row {
  double turn_deg = 0;                   // opening
  double forward[2] = {}, drop[2] = {};  // left, right; mm
  double medial[2] = {};
};

std::vector<Row> rows_of(const Case& patient, const Motion& motion, const Vector3d& left,
                         const Vector3d& right) {
  std::vector<double> times = motion.sample_times;
  constexpr int moments = 200;
  if (times.empty())
    for (int k = 0; k <= moments; ++k) times.push_back(motion.duration_s * k / moments);
  // Forward and down along the Frankfort plane.
  Eigen::Quaterniond level = Eigen::Quaterniond::Identity();
  if (const auto slope = frankfort_slope(patient))
    level = Eigen::AngleAxisd(-*slope, Vector3d::UnitX());
  std::vector<Row> rows;
  for (const double time : times) {
    const Pose X = motion.wanted(time);
    Row row;
    const Eigen::AngleAxisd turn(X.R.w() < 0 ? Eigen::Quaterniond(-X.R.coeffs()) : X.R);
    row.turn_deg = turn.angle() * turn.axis().x() / radian_per_degree;
    for (int side = 0; side < 2; ++side) {
      const Vector3d& seat = side == 0 ? left : right;
      const Vector3d way = level * (X * seat - seat);
      row.forward[side] = -way.y();
      row.drop[side] = -way.z();
      row.medial[side] = side == 0 ? -way.x() : way.x();
    }
    rows.push_back(row);
  }
  return rows;
}

/// Angle of the secant, from a cubic through the seat.
std::optional<double> inclination_deg(const std::vector<Row>& rows, int side) {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  int count = 0;
  double farthest = 0;
  for (const Row& row : rows) {
    const double f = row.forward[side];
    if (f < 0 || f > path_used_mm) continue;
    const Vector3d powers(f, f * f, f * f * f);
    A += powers * powers.transpose();
    b += row.drop[side] * powers;
    farthest = std::max(farthest, f);
    count += f > path_shown_mm / 2;
  }
  if (farthest < path_shown_mm || count < least_rows) return std::nullopt;
  const Vector3d c = A.ldlt().solve(b);
  const double f = std::min(secant_mm, farthest);
  return std::atan(c[0] + f * (c[1] + f * c[2])) / radian_per_degree;
}

void fit_side_shift(const std::vector<Row>& rows, int side, JointFit::Side& out) {
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  int count = 0;
  double farthest = 0;
  for (const Row& row : rows) {
    const double f = row.forward[side];
    if (f < 0 || f - row.forward[1 - side] < orbits_by_mm) continue;
    const Eigen::Vector2d terms(1 - std::exp(-f / shift_length_mm), f);
    A += terms * terms.transpose();
    b += row.medial[side] * terms;
    farthest = std::max(farthest, f);
    ++count;
  }
  if (farthest < path_shown_mm || count < least_rows) return;
  const Eigen::Vector2d c = A.ldlt().solve(b);
  out.side_shift_mm = c[0];
  out.bennett_deg = std::atan(c[1]) / radian_per_degree;
}

/// Forward travel over opening as a straight rise after the hinge: the break that fits best.
void fit_hinge(const std::vector<Row>& rows, JointFit& out) {
  std::vector<std::pair<double, double>> points;  // turn, forward
  double farthest = 0, widest = 0;
  for (const Row& row : rows)
    if (std::abs(row.forward[0] - row.forward[1]) < together_mm && row.turn_deg > 0) {
      points.emplace_back(row.turn_deg, 0.5 * (row.forward[0] + row.forward[1]));
      farthest = std::max(farthest, points.back().second);
      widest = std::max(widest, row.turn_deg);
    }
  if (static_cast<int>(points.size()) < least_rows || farthest < path_shown_mm ||
      widest < turned_least_deg)
    return;
  // Near the end of their travel condyles may turn on the spot again.
  constexpr double used_share = 0.85, fine_deg = 0.05;
  double least = 1e300;
  for (double hinge = 0; hinge < widest - 1; hinge += fine_deg) {
    double xx = 0, xy = 0, yy = 0;
    for (const auto& [turn, forward] : points) {
      if (forward > used_share * farthest) continue;
      const double x = std::max(turn - hinge, 0.0);
      xx += x * x;
      xy += x * forward;
      yy += forward * forward;
    }
    if (!(xy > 0)) continue;
    const double miss = yy - xy * xy / xx;
    if (miss >= least) continue;
    least = miss;
    out.hinge_deg = hinge;
    out.deg_per_mm = xx / xy;
  }
}

}  // namespace

std::optional<double> frankfort_slope(const Case& patient) {
  const auto mean = [&](const std::string& name) -> std::optional<Vector3d> {
    const auto left = patient.landmarks.find("left_" + name),
               right = patient.landmarks.find("right_" + name);
    if (!left && !right) return std::nullopt;
    return left && right ? Vector3d(0.5 * (*left + *right)) : left ? *left : *right;
  };
  const auto porion = mean("porion"), orbitale = mean("orbitale");
  if (!porion || !orbitale || porion->y() - orbitale->y() < 20) return std::nullopt;
  return std::atan2(porion->z() - orbitale->z(), porion->y() - orbitale->y());
}

std::optional<JointFit> fit_joint(const Case& patient, const Motion& motion) {
  const auto left = patient.landmarks.find("left_condyle"),
             right = patient.landmarks.find("right_condyle");
  if (!left || !right) return std::nullopt;
  const auto rows = rows_of(patient, motion, *left, *right);
  JointFit fit;
  fit.to_frankfort = frankfort_slope(patient).has_value();
  for (int side = 0; side < 2; ++side) {
    JointFit::Side& out = side == 0 ? fit.left : fit.right;
    for (const Row& row : rows) out.travel_mm = std::max(out.travel_mm, row.forward[side]);
    out.inclination_deg = inclination_deg(rows, side);
    fit_side_shift(rows, side, out);
  }
  fit_hinge(rows, fit);
  return fit;
}

std::vector<std::string> describe(const JointFit& fit) {
  std::vector<std::string> out;
  const auto& [l, r] = std::pair{fit.left, fit.right};
  if (l.inclination_deg || r.inclination_deg) {
    const auto text = [](const std::optional<double>& deg) {
      return deg ? fmt::format("{:.1f} deg", *deg) : std::string("not shown");
    };
    out.push_back(fmt::format("condylar inclination left {}, right {}, to the {}",
                              text(l.inclination_deg), text(r.inclination_deg),
                              fit.to_frankfort ? "Frankfort plane" : "horizontal"));
  }
  for (const auto& [name, side] : {std::pair{"left", &l}, std::pair{"right", &r}})
    if (side->bennett_deg)
      out.push_back(fmt::format("Bennett angle {} {:.1f} deg, immediate side shift {:.2f} mm", name,
                                *side->bennett_deg, *side->side_shift_mm));
  if (fit.hinge_deg)
    out.push_back(fmt::format("hinge phase to {:.1f} deg, then {:.2f} deg for each mm forward",
                              *fit.hinge_deg, *fit.deg_per_mm));
  return out;
}

}  // namespace condyle
