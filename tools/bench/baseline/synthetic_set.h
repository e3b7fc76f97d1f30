#pragma once

#include "engine/math/pose.h"
#include "engine/tissue/layered_mesh.h"

namespace condyle {

/// Size of a synthetic tissue: `columns` and `rim` are those of the sheet (rim: its border).
struct SyntheticSize {
  int columns = 46, rim = 18, layers = 2;
  int bone_springs = 21;
  std::vector<int> boundary_sheets = {0, 1, 2};  // sheets whose rim is held
  // The rim below the hinge moves with the lower bone, as skin around it does; else it stays, and
  // the tissue is crushed against it.
  bool rim_moves = false;
};

/// Sizes of the published experiments: 138 positions, 986 springs, 144 volumes; the second
/// patient's 2092, 16547, 2820; and the first's 754, 6067, 874, which no sheets of one triangle
/// mesh make: 753, 5688, 874 is the nearest.
SyntheticSize table1_size();
SyntheticSize patient1_size();
SyntheticSize patient2_size();
/// About that many nodes in three layers, otherwise like the second patient.
SyntheticSize size_of_nodes(int nodes);

/// A bent slab of tissue over two bones, the size of a lower face: the upper bone stays, the lower
/// one moves about a hinge behind it. Bone springs far from the line between the bones; nearer to
/// it the tissue is free.
struct SyntheticSet {
  std::vector<Eigen::Vector3i> triangles;
  int columns = 0, sheets = 0;
  Nodes rest;  // mm
  SpringPrismMesh mesh;
  std::vector<char> anchor_moves;     // per anchor: whether it moves with the lower bone
  std::vector<double> node_fraction;  // per node: smooth, 1 with the lower bone, 0 at rest
  Nodes anchor_offset;                // per anchor, from balance_strains; zero without

  int springs() const { return static_cast<int>(mesh.spring_a.size() + mesh.anchor_node.size()); }
};
/// Layers from the skin inward, with the thickness fraction of each; 1, 2, 3 or 5 of them.
SyntheticSet make_synthetic_set(const SyntheticSize& size);

/// The lower bone turned about the hinge and moved.
Pose synthetic_pose(double opening_rad, const Eigen::Vector3d& moved_mm);

MeshLoads synthetic_loads(const SyntheticSet& set, const Pose& lower_bone);

/// x with each node moved by its fraction of the motion from one pose of the lower bone to another.
Nodes carried(const SyntheticSet& set, const Nodes& x, const Pose& from, const Pose& to);

}  // namespace condyle
