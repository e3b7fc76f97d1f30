#include "engine/rigid/mass_properties.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>

#include "engine/core/error.h"

namespace condyle {

using Eigen::Matrix3d;
using Eigen::Vector3d;

MassProperties mass_properties(const TriMesh& mesh, double density_kg_mm3) {
  if (!(density_kg_mm3 > 0) || !std::isfinite(density_kg_mm3))
    throw InputError("a density of " + std::to_string(density_kg_mm3) +
                     " kg/mm^3 is not a positive number");
  // Sum of the volumes and of the first and second moments of signed tetrahedra.
  const Vector3d o = mesh.empty() ? Vector3d::Zero() : mesh.vertices[mesh.triangles[0][0]];
  double volume = 0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();  // integral of x x^T about o
  for (const auto& t : mesh.triangles) {
    const Vector3d a = mesh.vertices[t[0]] - o, b = mesh.vertices[t[1]] - o,
                   c = mesh.vertices[t[2]] - o;
    const double v = a.dot(b.cross(c)) / 6;
    const Vector3d sum = a + b + c;
    volume += v;
    first += v / 4 * sum;
    second += v / 20 *
              (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  if (!(volume > 0) || !std::isfinite(volume))
    throw InputError("the mesh encloses " + std::to_string(volume) +
                     " mm^3: a body that moves freely needs a closed surface that faces outward");
  MassProperties out;
  out.mass_kg = density_kg_mm3 * volume;
  const Vector3d c = first / volume;
  out.center = o + c;
  const Matrix3d about_center = second - volume * c * c.transpose();
  out.inertia = density_kg_mm3 * (about_center.trace() * Matrix3d::Identity() - about_center);
  return out;
}

MassProperties joined(const MassProperties& a, const MassProperties& b) {
  MassProperties out;
  out.mass_kg = a.mass_kg + b.mass_kg;
  if (!(out.mass_kg > 0)) return out;
  out.center = (a.mass_kg * a.center + b.mass_kg * b.center) / out.mass_kg;
  for (const MassProperties* part : {&a, &b}) {
    const Vector3d d = part->center - out.center;
    out.inertia += part->inertia +
                   part->mass_kg * (d.squaredNorm() * Matrix3d::Identity() - d * d.transpose());
  }
  return out;
}

double min_moment(const MassProperties& mass) {
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(mass.inertia, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

}  // namespace condyle
