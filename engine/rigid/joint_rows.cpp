#include "engine/rigid/joint_rows.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/error.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Rotation vector of R (axis times angle) of least angle.
Vector3d rotation_vector(const Eigen::Quaterniond& R) {
  const double sine = R.vec().norm();
  if (sine < 1e-300) return Vector3d::Zero();
  const double angle = 2 * std::atan2(sine, std::abs(R.w()));
  return (R.w() < 0 ? -angle : angle) / sine * R.vec();
}

}  // namespace

JointRows::JointRows(const RigidJoint& joint) : joint_(joint) {
  const auto fail = [](const std::string& problem) { throw InputError("joint: " + problem); };
  if (!joint.p_A.allFinite() || !joint.p_B.allFinite() || !joint.X_AB.t.allFinite() ||
      !joint.X_AB.R.coeffs().allFinite())
    fail("a point or pose is not finite");
  if (!(joint.max_force_N > 0) || !std::isfinite(joint.max_force_N))
    fail("the largest force, " + std::to_string(joint.max_force_N) + " N, must be positive");
  const auto make_unit = [&](Vector3d& v) {
    const double length = v.norm();
    if (!(length > 0) || !std::isfinite(length)) fail("a direction has no length");
    v /= length;
  };
  if (joint.kind == RigidJoint::Kind::hinge) {
    make_unit(joint_.axis_A);
    make_unit(joint_.axis_B);
  }
  if (joint.kind == RigidJoint::Kind::plane) make_unit(joint_.axis_A);
  if (joint.kind == RigidJoint::Kind::guide) {
    if (joint_.sideways_A) make_unit(*joint_.sideways_A);
    curve_.emplace(joint.curve_A);
  }
}

int JointRows::count() const {
  switch (joint_.kind) {
    case RigidJoint::Kind::ball:
      return 3;
    case RigidJoint::Kind::hinge:
      return 5;
    case RigidJoint::Kind::fixed:
      return 6;
    case RigidJoint::Kind::plane:
      return 1;
    default:
      return joint_.sideways_A ? 3 : 4;
  }
}

double JointRows::append(const JointBody& a, const JointBody& b, double step_s,
                         std::span<const double> impulses, std::vector<JointRow>& rows) const {
  const std::size_t first = rows.size();
  const double limit = joint_.max_force_N * 1000 * step_s;
  const bool is_fixed = joint_.kind == RigidJoint::Kind::fixed;
  const Vector3d p_WB = b.X_WB * (is_fixed ? Vector3d::Zero() : joint_.p_B);
  const auto add = [&](const Vector3d& along, const Vector3d& turn_a, const Vector3d& turn_b,
                       double error) {
    JointRow row;
    row.a = a.solver;
    row.b = b.solver;
    row.along = along;
    row.turn_a = turn_a;
    row.turn_b = turn_b;
    row.error = error;
    row.low = -limit;
    row.high = limit;
    if (a.solver < 0)
      row.target_velocity += along.dot(a.motion.velocity) + turn_a.dot(a.motion.spin);
    if (b.solver < 0)
      row.target_velocity -= along.dot(b.motion.velocity) + turn_b.dot(b.motion.spin);
    row.impulse = impulses.empty() ? 0.0 : impulses[rows.size() - first];
    rows.push_back(row);
  };
  // The point of B, and the same point moving with A, follow the direction of the row. Half a step
  // of rotation of the row makes the point end on the constraint instead of beside it and conserves
  // energy.
  const auto bend = [&](const JointBody& body) {
    return Vector3d(body.motion.spin.cross(body.motion.spin.cross(p_WB - body.center)));
  };
  const Vector3d bending = 0.5 * step_s * (bend(b) - bend(a));
  const auto hold = [&](const Vector3d& along, double error) {
    add(along, (p_WB - a.center).cross(along), (p_WB - b.center).cross(along), error);
    rows.back().target_velocity -= along.dot(bending);
  };
  const auto turn = [&](const Vector3d& axis, double error) {
    add(Vector3d::Zero(), axis, axis, error);
  };
  /// One-sided: the point may move by `room` against the direction.
  const auto stop = [&](const Vector3d& along, double room) {
    hold(along, std::min(room, 0.0));
    rows.back().low = 0;
    rows.back().target_velocity -= std::max(room, 0.0) / step_s;
    rows.back().impulse = std::max(rows.back().impulse, 0.0);
  };

  const Eigen::Quaterniond& R = a.X_WB.R;
  if (joint_.kind == RigidJoint::Kind::guide) {
    const auto place = curve_->nearest(a.X_WB.inverse() * p_WB, joint_.sideways_A);
    const Vector3d off = p_WB - a.X_WB * place.point;
    const Vector3d along = R * place.along;
    const Vector3d across = joint_.sideways_A ? Vector3d(R * *joint_.sideways_A).cross(along)
                                              : Vector3d(R * place.along.unitOrthogonal());
    hold(across.normalized(), off.dot(across.normalized()));
    if (!joint_.sideways_A) hold(along.cross(across), off.dot(along.cross(across)));
    stop(along, place.from_start_mm);
    stop(-along, place.from_end_mm);
  } else if (joint_.kind == RigidJoint::Kind::plane) {
    const Vector3d axis = R * joint_.axis_A;
    stop(axis, (p_WB - a.X_WB * joint_.p_A).dot(axis));
  } else {
    const Vector3d off = p_WB - a.X_WB * (is_fixed ? joint_.X_AB.t : joint_.p_A);
    for (int k = 0; k < 3; ++k) hold(Vector3d::Unit(k), off[k]);
    if (joint_.kind == RigidJoint::Kind::hinge) {
      const Vector3d axis = R * joint_.axis_A;
      const Vector3d lean = axis.cross(b.X_WB.R * joint_.axis_B);
      const Vector3d u = R * joint_.axis_A.unitOrthogonal(), v = axis.cross(u);
      turn(u, lean.dot(u));
      turn(v, lean.dot(v));
    } else if (is_fixed) {
      const Vector3d lean = rotation_vector(b.X_WB.R * (R * joint_.X_AB.R).conjugate());
      for (int k = 0; k < 3; ++k) turn(Vector3d::Unit(k), lean[k]);
    }
  }
  double error = 0;
  for (std::size_t r = first; r < rows.size(); ++r)
    error = std::max(error, std::abs(rows[r].error));
  return error;
}

}  // namespace condyle
