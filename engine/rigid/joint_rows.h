#pragma once

#include <optional>
#include <vector>

#include "engine/rigid/constraint_solver.h"
#include "engine/rigid/guide_curve.h"
#include "engine/rigid/joint.h"

namespace condyle {

/// State of a body as needed by joints.
struct JointBody {
  int solver = -1;  // its index in the solver; -1: not free
  Pose X_WB;
  Eigen::Vector3d center;  // of mass, world
  SolverMotion motion;
};

/// A validated joint that gives its constraint rows at any pose.
class JointRows {
 public:
  /// throws: InputError where points are not finite, directions have no length, or a guide has no
  /// curve.
  explicit JointRows(const RigidJoint& joint);

  int a() const { return joint_.a; }
  int b() const { return joint_.b; }
  int count() const;

  /// Appends count() rows; `impulses`: initial values from an earlier step. Returns the joint's
  /// position error: the largest of its rows, mm (rad for directions).
  double append(const JointBody& a, const JointBody& b, double step_s,
                std::span<const double> impulses, std::vector<JointRow>& rows) const;

 private:
  RigidJoint joint_;
  std::optional<GuideCurve> curve_;
};

}  // namespace condyle
