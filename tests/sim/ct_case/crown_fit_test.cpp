#include "sim/ct_case/crown_fit.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "engine/core/units.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/phantom/phantom.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr VoxelLabel jaw_label = 2;

/// The built-in lower jaw with its teeth as voxels of 0.8 mm.
struct VoxelJaw {
  TriMesh teeth, bone;
  Volume volume;
  BoneVoxels voxels;

  VoxelJaw() {
    const Case patient = builtin_patient();
    for (const Part& part : patient.parts) {
      if (part.role == Role::lower_teeth) teeth = part.mesh;
      if (part.role == Role::mandible) bone = part.mesh;
    }
    constexpr double voxel_mm = 0.8, around_mm = 14;
    const Box box = bounding_box(teeth);
    volume.spacing_mm = Vector3d::Constant(voxel_mm);
    volume.origin = box.low - Vector3d::Constant(around_mm);
    const Vector3d size = box.high - box.low + Vector3d::Constant(2 * around_mm);
    for (int a = 0; a < 3; ++a)
      volume.size[static_cast<std::size_t>(a)] = static_cast<int>(size[a] / voxel_mm);
    voxels.box = whole_box(volume);
    const TriangleTree of_teeth(teeth), of_bone(bone);
    for (int k = 0; k < volume.size[2]; ++k)
      for (int j = 0; j < volume.size[1]; ++j)
        for (int i = 0; i < volume.size[0]; ++i) {
          const Vector3d p = volume.position(i, j, k);
          const bool inside = of_teeth.signed_nearest(p, 8).distance < 0 ||
                              of_bone.signed_nearest(p, 8).distance < 0;
          voxels.label.push_back(inside ? jaw_label : no_bone);
        }
  }
};

const VoxelJaw& voxel_jaw() {
  static const VoxelJaw jaw;
  return jaw;
}

TEST(CrownFit, CrownsThatTheJawsFitMissedAreFound) {
  const VoxelJaw& jaw = voxel_jaw();
  const Vector3d middle = 0.5 * (bounding_box(jaw.teeth).low + bounding_box(jaw.teeth).high);
  Pose off;
  off.R = Eigen::AngleAxisd(6 * degree, Vector3d::UnitX());
  off.t = middle - off.R * middle + Vector3d(1, 4, -5);  // behind and below the true ones
  TriMesh fitted = jaw.teeth;
  for (Vector3d& p : fitted.vertices) p = off * p;
  const auto fit = fit_crowns(jaw.volume, jaw.voxels, jaw_label, fitted, jaw.bone);
  ASSERT_TRUE(fit);
  EXPECT_GT(fit->after, fit->before + 0.3);
  double error = 0;
  for (std::size_t v = 0; v < fitted.vertices.size(); ++v)
    error += (fit->X * fitted.vertices[v] - jaw.teeth.vertices[v]).norm();
  EXPECT_LT(error / static_cast<double>(fitted.vertices.size()), 0.8);
}

TEST(CrownFit, CrownsThatLieRightStay) {
  const VoxelJaw& jaw = voxel_jaw();
  EXPECT_FALSE(fit_crowns(jaw.volume, jaw.voxels, jaw_label, jaw.teeth, jaw.bone));
  EXPECT_FALSE(fit_crowns(jaw.volume, jaw.voxels, jaw_label, {}, jaw.bone));
  EXPECT_FALSE(fit_crowns(jaw.volume, jaw.voxels, jaw_label, jaw.teeth, {}));
}

TEST(CrownFit, TheLandmarksOfTheTeethMoveWithTheCrowns) {
  AnatomyFit fit;
  CarriedPart teeth;
  teeth.part.role = Role::lower_teeth;
  teeth.part.mesh = voxel_jaw().teeth;
  fit.parts.push_back(teeth);
  for (const char* name :
       {"lower_incisal_point", "lower_left_canine_tip", "menton", "upper_incisal_point"})
    fit.landmarks[name].point = Vector3d(1, 2, 3);
  move_crowns(Role::lower_teeth, {Eigen::Quaterniond::Identity(), {0, -5, 6}}, fit);
  EXPECT_EQ(fit.landmarks.at("lower_incisal_point").point, Vector3d(1, -3, 9));
  EXPECT_EQ(fit.landmarks.at("lower_left_canine_tip").point, Vector3d(1, -3, 9));
  EXPECT_EQ(fit.landmarks.at("menton").point, Vector3d(1, 2, 3));
  EXPECT_EQ(fit.landmarks.at("upper_incisal_point").point, Vector3d(1, 2, 3));
  EXPECT_EQ(fit.parts[0].part.mesh.vertices[0], voxel_jaw().teeth.vertices[0] + Vector3d(0, -5, 6));
}

}  // namespace
}  // namespace condyle
