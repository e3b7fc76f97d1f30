#include "sim/dynamics/bite_plane.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double molar_fraction = 0.55;  // of the arch's depth, from the front
constexpr double around_mm = 4;          // along the arch
constexpr double top_mm = 2;             // chewing surface below the highest cusp

std::optional<Vector3d> landmark(const Case& patient, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (const auto point = patient.landmarks.find(name)) return point;
  return std::nullopt;
}

/// Centre of the occlusal surface of the first molar on one side.
std::optional<Vector3d> molar(const Part& lower, double middle_x, double side) {
  const Box box = bounding_box(lower.mesh);
  const double y = box.low.y() + molar_fraction * box.size().y();
  double highest = -1e300;
  const auto here = [&](const Vector3d& v) {
    return std::abs(v.y() - y) < around_mm && side * (v.x() - middle_x) > 0;
  };
  for (const Vector3d& v : lower.mesh.vertices)
    if (here(v)) highest = std::max(highest, v.z());
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (const Vector3d& v : lower.mesh.vertices)
    if (here(v) && v.z() > highest - top_mm) sum += v, ++count;
  if (count == 0) return std::nullopt;
  return sum / count;
}

}  // namespace

BitePlane bite_plane(const Case& patient) {
  const auto incisor = landmark(patient, {"lower_incisal_point"});
  const auto left_condyle = landmark(patient, {"left_condyle"}),
             right_condyle = landmark(patient, {"right_condyle"});
  if (!incisor || !left_condyle || !right_condyle)
    throw InputError(patient.name +
                     ": condyles and the lower incisal point are needed to locate the bite");
  std::optional<Vector3d> left = landmark(patient, {"left_bite", "lbite"}),
                          right = landmark(patient, {"right_bite", "rbite"});
  if (const Part* lower = patient.teeth_of(patient.jaw.lower_arch); lower && !lower->mesh.empty()) {
    if (!left) left = molar(*lower, incisor->x(), 1);
    if (!right) right = molar(*lower, incisor->x(), -1);
  }
  // At a third of the distance to the condyles, with half their separation.
  const Vector3d middle = 0.5 * (*left_condyle + *right_condyle);
  const Vector3d back = *incisor + (middle - *incisor) / 3,
                 aside = 0.25 * (*left_condyle - *right_condyle);
  BitePlane plane;
  plane.left = left.value_or(back + aside);
  plane.right = right.value_or(back - aside);
  plane.normal = (plane.right - *incisor).cross(plane.left - *incisor).normalized();
  if (plane.normal.z() > 0) plane.normal = -plane.normal;
  return plane;
}

}  // namespace condyle
