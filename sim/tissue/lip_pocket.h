#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// The line where the lips of a closed mouth meet, projected to the front, mm: corners and middle.
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

/// Scans of closed mouths often have a pocket between the lips, whose walls belong to either lip:
/// the lips separate along its bottom, not where a plane cuts the walls. Returns the vertices along
/// edges, from the right corner of the mouth to the left, where the pocket is deepest; empty
/// without a pocket, or when a hole interrupts it. The face points to -y.
std::vector<int> pocket_bottom(const TriMesh& face, const LipLine& line);

/// Modelled faces often have an oral cavity behind the lips, a pouch: they are open there, and its
/// corners are those of the mouth. Keeps only the inner seam of the lips. `bottom`: vertices deep
/// in it. Returns false, and changes nothing, when there is no pouch.
bool open_pouch(TriMesh& face, const LipLine& line, const std::vector<int>& bottom);

/// Cuts a surface along a chain of its edges, none of them on a border: all vertices except the
/// ends are duplicated (at the end of the list, with colours); the triangles to the right of the
/// chain, viewed from outside, use the duplicates.
void cut_along(const std::vector<int>& run, TriMesh& surface);

}  // namespace condyle
