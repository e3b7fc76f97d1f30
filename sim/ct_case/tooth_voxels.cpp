#include "sim/ct_case/tooth_voxels.h"

#include <algorithm>

#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double around_teeth_mm = 3;  // of the template's teeth, in which scanned ones may lie

}  // namespace

void label_teeth(const Volume& volume, const TriMesh& template_teeth, const TriMesh& template_bone,
                 VoxelLabel bone_label, VoxelLabel teeth_label, BoneVoxels& bone, int threads) {
  if (template_teeth.empty() || template_bone.empty()) return;
  const TriangleTree teeth(template_teeth), around(template_bone);
  Box box = bounding_box(template_teeth);
  box.low -= Vector3d::Constant(around_teeth_mm);
  box.high += Vector3d::Constant(around_teeth_mm);
  parallel_for(static_cast<std::size_t>(bone.box.size[2]), threads, [&](std::size_t slice) {
    const int k = static_cast<int>(slice);
    for (int j = 0; j < bone.box.size[1]; ++j)
      for (int i = 0; i < bone.box.size[0]; ++i) {
        VoxelLabel& label = bone.label[bone.box.index(i, j, k)];
        if (label != bone_label) continue;
        const Vector3d p = bone.box.position(volume, i, j, k);
        if (!box.contains(p)) continue;
        const double to_teeth = teeth.signed_distance(p);
        if (to_teeth < around_teeth_mm && to_teeth < around.signed_distance(p)) label = teeth_label;
      }
  });
}

}  // namespace condyle
