#include "sim/ct_case/tooth_voxels.h"

#include <algorithm>
#include <cmath>
#include <numeric>

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

Part teeth_part(TriMesh mesh, const Part& template_teeth) {
  Part part{template_teeth.name,
            template_teeth.role,
            std::move(mesh),
            {},
            default_body(template_teeth.role)};
  if (part.mesh.empty() || template_teeth.teeth.empty()) return part;
  const TriangleTree tree(template_teeth.mesh);
  const auto tooth_of = [&](const Eigen::Vector3i& t) {
    const Vector3d middle = (part.mesh.vertices[static_cast<std::size_t>(t[0])] +
                             part.mesh.vertices[static_cast<std::size_t>(t[1])] +
                             part.mesh.vertices[static_cast<std::size_t>(t[2])]) /
                            3;
    const int nearest = tree.nearest(middle).triangle;
    const auto& teeth = template_teeth.teeth;
    const auto found = std::find_if(teeth.begin(), teeth.end(), [&](const Tooth& tooth) {
      return nearest >= tooth.first_triangle &&
             nearest < tooth.first_triangle + tooth.triangle_count;
    });
    return static_cast<std::size_t>(found - teeth.begin());
  };
  std::vector<std::vector<Eigen::Vector3i>> of_tooth(template_teeth.teeth.size() + 1);
  for (const auto& t : part.mesh.triangles) of_tooth[tooth_of(t)].push_back(t);
  part.mesh.triangles.clear();
  for (std::size_t i = 0; i < of_tooth.size(); ++i) {
    const int first = static_cast<int>(part.mesh.triangles.size());
    part.mesh.triangles.insert(part.mesh.triangles.end(), of_tooth[i].begin(), of_tooth[i].end());
    if (i < template_teeth.teeth.size() && !of_tooth[i].empty())
      part.teeth.push_back(
          {template_teeth.teeth[i].fdi, first, static_cast<int>(of_tooth[i].size())});
  }
  return part;
}

}  // namespace condyle
