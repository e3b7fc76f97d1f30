#include "sim/appliance/grid_frame.h"

#include <cmath>

namespace condyle {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d axes_along(const Vector3d& z) {
  const Vector3d x = std::abs(z.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitY();
  Matrix3d R;
  R.row(2) = z.transpose();
  R.row(0) = (x - x.dot(z) * z).normalized().transpose();
  R.row(1) = R.row(2).cross(R.row(0));
  return R;
}

TriMesh in_axes(TriMesh mesh, const Matrix3d& R, const Pose& X) {
  for (Vector3d& p : mesh.vertices) p = R * (X * p);
  mesh.colors.clear();
  return mesh;
}

void append(TriMesh& mesh, const TriMesh& more) {
  const int first = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& t : more.triangles)
    mesh.triangles.emplace_back(t.x() + first, t.y() + first, t.z() + first);
}

}  // namespace condyle
