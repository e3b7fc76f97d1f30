#include "sim/ct_case/open_joints.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "sim/motion/joint_surfaces.h"
#include "sim/phantom/phantom.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

Part& part_of(Case& patient, Role role) {
  for (Part& part : patient.parts)
    if (part.role == role) return part;
  throw std::logic_error("no such part");
}

TEST(OpenJoints, CondylesThatTouchTheSkullAreMovedApartLocally) {
  Case patient = builtin_patient();
  TriMesh& jaw = part_of(patient, Role::mandible).mesh;
  constexpr double step_mm = 0.1;
  double up_mm = 0;
  for (; up_mm < 8 && JointSurfaces::find(patient); up_mm += step_mm)
    for (Vector3d& p : jaw.vertices) p.z() += step_mm;
  ASSERT_LT(up_mm, 8);  // now they touch
  const TriMesh before = jaw;
  const double moved_mm = open_joints(patient);
  EXPECT_TRUE(JointSurfaces::find(patient));
  EXPECT_GT(moved_mm, 0.005);
  EXPECT_LT(moved_mm, 0.5);
  const Vector3d chin = patient.landmarks.points.at("menton");
  for (std::size_t v = 0; v < jaw.vertices.size(); ++v) {
    const double shift = (jaw.vertices[v] - before.vertices[v]).norm();
    EXPECT_LE(shift, moved_mm);
    if ((before.vertices[v] - chin).norm() < 50) {
      EXPECT_EQ(shift, 0);
    }
  }
}

TEST(OpenJoints, JointsWithAGapKeepTheirBits) {
  Case patient = builtin_patient();
  const Case before = patient;
  EXPECT_EQ(open_joints(patient), 0);
  for (std::size_t i = 0; i < patient.parts.size(); ++i)
    EXPECT_EQ(patient.parts[i].mesh.vertices, before.parts[i].mesh.vertices);
}

}  // namespace
}  // namespace condyle
