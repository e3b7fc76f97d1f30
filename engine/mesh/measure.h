#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Axis-aligned box, mm. Empty (low > high) until a point is added.
struct Box {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;

  bool empty() const { return !(low.array() <= high.array()).all(); }
  Eigen::Vector3d size() const {
    return empty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(high - low);
  }
  Eigen::Vector3d center() const { return 0.5 * (low + high); }
  void add(const Eigen::Vector3d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void add(const Box& box) {
    low = low.cwiseMin(box.low);
    high = high.cwiseMax(box.high);
  }
  bool contains(const Eigen::Vector3d& p, double margin = 0) const {
    return ((p - low).array() >= -margin).all() && ((high - p).array() >= -margin).all();
  }
};

/// Box of all vertices, referenced or not.
Box bounding_box(const TriMesh& mesh);

/// mm^2
double surface_area(const TriMesh& mesh);

/// mm^3; positive for a closed mesh whose triangles face outward. For an open mesh it depends on
/// the position of the hole and has no meaning.
double signed_volume(const TriMesh& mesh);

/// Unit normals weighted by corner angles; zero at vertices without a triangle that has area.
/// shape: one per vertex.
std::vector<Eigen::Vector3d> vertex_normals(const TriMesh& mesh);

/// Hash of the bits of vertices, triangles and colours: equal meshes, equal hash.
std::uint64_t mesh_hash(const TriMesh& mesh);

}  // namespace condyle
