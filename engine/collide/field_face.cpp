#include "engine/collide/field_face.h"

#include <Eigen/Geometry>

namespace condyle {

using Eigen::Vector3d;

FieldFace field_face(const Shell& shell, int shell_index, int triangle) {
  const auto& t = shell.mesh.triangles[static_cast<std::size_t>(triangle)];
  FieldFace f;
  f.a = shell.mesh.vertices[t[0]];
  f.ab = shell.mesh.vertices[t[1]] - f.a;
  f.ac = shell.mesh.vertices[t[2]] - f.a;
  f.normal = f.ab.cross(f.ac);
  f.bb = f.ab.squaredNorm();
  f.bc = f.ab.dot(f.ac);
  f.cc = f.ac.squaredNorm();
  f.shell = shell_index;
  f.triangle = triangle;
  f.rim = shell.rim[static_cast<std::size_t>(triangle)];
  return f;
}

/// source: Ericson, Real-Time Collision Detection, 5.1.5.
double nearest(const FieldFace& f, const Vector3d& p, Vector3d& at) {
  const Vector3d ap = p - f.a;
  const double d1 = f.ab.dot(ap), d2 = f.ac.dot(ap);
  const double d3 = d1 - f.bb, d4 = d2 - f.bc, d5 = d1 - f.bc, d6 = d2 - f.cc;
  double v = 0, w = 0;
  at.setZero();
  if (d1 <= 0 && d2 <= 0) {
    at[0] = 1;
  } else if (d3 >= 0 && d4 <= d3) {
    at[1] = v = 1;
  } else if (d6 >= 0 && d5 <= d6) {
    at[2] = w = 1;
  } else {
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
      v = d1 / (d1 - d3);
      at = {1 - v, v, 0};
    } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
      w = d2 / (d2 - d6);
      at = {1 - w, 0, w};
    } else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
      w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
      v = 1 - w;
      at = {0, v, w};
    } else {
      const double sum = va + vb + vc;
      v = vb / sum;
      w = vc / sum;
      at = {1 - v - w, v, w};
    }
  }
  return (ap - v * f.ab - w * f.ac).squaredNorm();
}

bool on_rim(const FieldFace& f, const Vector3d& at) {
  if (f.rim == 0) return false;
  const int zeros = (at[0] == 0) + (at[1] == 0) + (at[2] == 0);
  for (int k = 0; k < 3; ++k) {
    if (zeros == 2 && at[k] != 0) return f.rim & (8 << k);
    if (zeros == 1 && at[k] == 0) return f.rim & (1 << (k + 1) % 3);
  }
  return false;
}

FacePlanes::FacePlanes(const FieldFace& f, const Vector3d& center) {
  out_.setZero();
  along_.setZero();
  length_.setZero();
  const double longest2 = std::max({f.bb, f.cc, (f.ac - f.ab).squaredNorm()});
  if (f.normal.norm() < 1e-5 * longest2) return;
  const auto set = [&](Eigen::Matrix4f& rows, int row, const Vector3d& unit, const Vector3d& from) {
    rows.row(row) << unit.transpose().cast<float>(), static_cast<float>(unit.dot(center - from));
  };
  const Vector3d up = f.normal.normalized();
  set(out_, 0, up, f.a);
  const Vector3d corner[3] = {f.a, f.a + f.ab, f.a + f.ac};
  for (int k = 0; k < 3; ++k) {
    const Vector3d side = corner[(k + 1) % 3] - corner[k], unit = side.normalized();
    set(out_, k + 1, unit.cross(up), corner[k]);
    set(along_, k + 1, unit, corner[k]);
    length_[k + 1] = static_cast<float>(side.norm());
  }
}

}  // namespace condyle
