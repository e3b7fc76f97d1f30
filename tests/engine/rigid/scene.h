#pragma once

#include <Eigen/Geometry>
#include <numbers>

#include "engine/rigid/rigid_world.h"
#include "tests/support/boxes.h"
#include "tests/support/shapes.h"

namespace condyle::test {

constexpr double density = 1.9e-6;  // of bone, kg/mm^3

inline std::shared_ptr<const ContactSurface> surface(const TriMesh& mesh) {
  return std::make_shared<const ContactSurface>(make_contact_surface(mesh, {}, 2));
}

inline Pose at(double x, double y, double z) { return {Eigen::Quaterniond::Identity(), {x, y, z}}; }

inline Pose turned(const Eigen::Vector3d& axis, double degrees, const Eigen::Vector3d& t) {
  return {
      Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized())),
      t};
}

/// A free body of bone.
inline DynamicBody solid(const TriMesh& mesh, const Pose& X_WB,
                         std::shared_ptr<const ContactSurface> surface_of = nullptr) {
  DynamicBody body;
  body.mass = mass_properties(mesh, density);
  body.X_WB = X_WB;
  body.surfaces = {surface_of ? surface_of : surface(mesh)};
  return body;
}

/// The same without a surface: nothing touches it.
inline DynamicBody ghost(const TriMesh& mesh, const Pose& X_WB = {}) {
  DynamicBody body;
  body.mass = mass_properties(mesh, density);
  body.X_WB = X_WB;
  return body;
}

inline DynamicBody fixed(const TriMesh& mesh, const Pose& X_WB = {}) {
  DynamicBody body;
  body.X_WB = X_WB;
  body.surfaces = {surface(mesh)};
  return body;
}

inline RigidSettings weightless() {
  RigidSettings settings;
  settings.gravity_mm_s2.setZero();
  return settings;
}

inline void run(RigidWorld& world, double seconds, int threads = 1) {
  const int steps = static_cast<int>(std::lround(seconds / world.settings().step_s));
  for (int k = 0; k < steps; ++k) world.step(threads);
}

/// Largest displacement of a body between two poses, for points up to 10 mm from its origin.
inline double apart(const Pose& a, const Pose& b) {
  return (a.t - b.t).norm() + 10 * rotation_angle(a.inverse() * b);
}

}  // namespace condyle::test
