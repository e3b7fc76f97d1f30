#include "sim/motion/joint_fit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "sim/motion/condylar_kinematics.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double secant_mm = 5;      // forward travel over which the inclination is measured
constexpr double path_shown_mm = 3;  // forward travel needed to determine a path
constexpr double path_used_mm = 8;   // forward travel used for the fit
constexpr double orbits_by_mm =
    1;                             // lead over the other side that makes a condyle the orbiting one
constexpr double together_mm = 1;  // difference of forward travel in symmetric motion
constexpr double min_turn_deg = 5;  // rotation needed to determine a hinge phase
constexpr double shift_length_mm =
    1;  // forward travel over which the immediate side shift develops
constexpr int min_rows = 8;

struct Row {
  double turn_deg = 0;                   // opening rotation
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
    const Pose X = motion.target(time);
    Row row;
    const Eigen::AngleAxisd turn(X.R.w() < 0 ? Eigen::Quaterniond(-X.R.coeffs()) : X.R);
    row.turn_deg = turn.angle() * turn.axis().x() / degree;
    for (int side = 0; side < 2; ++side) {
      const Vector3d& seat = side == 0 ? left : right;
      const Vector3d d = level * (X * seat - seat);
      row.forward[side] = -d.y();
      row.drop[side] = -d.z();
      row.medial[side] = side == 0 ? -d.x() : d.x();
    }
    rows.push_back(row);
  }
  return rows;
}

/// Angle of the secant of a cubic through the rest position.
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
  if (farthest < path_shown_mm || count < min_rows) return std::nullopt;
  const Vector3d c = A.ldlt().solve(b);
  const double f = std::min(secant_mm, farthest);
  return std::atan(c[0] + f * (c[1] + f * c[2])) / degree;
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
  if (farthest < path_shown_mm || count < min_rows) return;
  const Eigen::Vector2d c = A.ldlt().solve(b);
  out.side_shift_mm = c[0];
  out.bennett_deg = std::atan(c[1]) / degree;
}

/// Fits forward travel as linear in rotation after a hinge phase, by search over its end.
void fit_hinge(const std::vector<Row>& rows, JointFit& out) {
  std::vector<std::pair<double, double>> points;  // turn, forward
  double farthest = 0, widest = 0;
  for (const Row& row : rows)
    if (std::abs(row.forward[0] - row.forward[1]) < together_mm && row.turn_deg > 0) {
      points.emplace_back(row.turn_deg, 0.5 * (row.forward[0] + row.forward[1]));
      farthest = std::max(farthest, points.back().second);
      widest = std::max(widest, row.turn_deg);
    }
  if (static_cast<int>(points.size()) < min_rows || farthest < path_shown_mm ||
      widest < min_turn_deg)
    return;
  // Near the end of travel the condyles may only rotate.
  constexpr double used_fraction = 0.85, fine_deg = 0.05;
  double min_error = 1e300;
  for (double hinge = 0; hinge < widest - 1; hinge += fine_deg) {
    double xx = 0, xy = 0, yy = 0;
    for (const auto& [turn, forward] : points) {
      if (forward > used_fraction * farthest) continue;
      const double x = std::max(turn - hinge, 0.0);
      xx += x * x;
      xy += x * forward;
      yy += forward * forward;
    }
    if (!(xy > 0)) continue;
    const double error = yy - xy * xy / xx;
    if (error >= min_error) continue;
    min_error = error;
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
      return deg ? fmt::format("{:.1f} deg", *deg) : std::string("not determined");
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
    out.push_back(
        fmt::format("hinge phase up to {:.1f} deg, then {:.2f} deg per mm of forward travel",
                    *fit.hinge_deg, *fit.deg_per_mm));
  return out;
}

}  // namespace condyle
