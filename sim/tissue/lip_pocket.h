#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Where the lips of a closed mouth meet, as seen from the front, mm: corners and middle.
struct LipLine {
  Eigen::Vector3d right, middle, left;

  /// Height above the line.
  double height(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d& a = p.x() < middle.x() ? right : middle;
    const Eigen::Vector3d& b = p.x() < middle.x() ? middle : left;
    return p.z() - (a.z() + (p.x() - a.x()) / (b.x() - a.x()) * (b.z() - a.z()));
  }
  bool spans(double x) const { return x > right.x() && x < left.x(); }
};

/// Scans of closed mouths often have a pocket between the lips, whose walls belong to one lip or
/// the other: they part along its bottom, not where a plane cuts the walls. Gives the vertices
/// along edges, from the right corner of the mouth to the left, where the pocket is deepest; empty
/// where there is none, or where a hole is in the way. The face looks to -y.
std::vector<int> pocket_bottom(const TriMesh& face, const LipLine& line);

/// Faces made by hand often have a whole mouth behind the lips, a pouch: they are open there, and
/// its corners are the mouth's. Leaves of it the lips' inner seam. `bottom`: vertices deep in it.
/// False, and nothing is changed, where the lips hide no pouch.
bool open_pouch(TriMesh& face, const LipLine& line, const std::vector<int>& bottom);

/// Cuts a surface along a run of its edges, none at a border: all vertices but the ends get a twin
/// (at the end of the list; colours too), which the triangles to the right of the run, seen from
/// outside, use.
void cut_along(const std::vector<int>& run, TriMesh& surface);

}  // namespace condyle
