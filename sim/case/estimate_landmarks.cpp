#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "sim/case/import_checks.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

std::string place_of(const Vector3d& p) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f})", p.x(), p.y(), p.z());
}

void adopt(Case& patient, const std::string& name, const Vector3d& p, const std::string& how) {
  patient.landmarks.points[name] = p;
  patient.notes.push_back(
      fmt::format("landmark {} is missing: estimated at {} from {}", name, place_of(p), how));
}

/// Centre of the bounding box of the top 10 mm of the posterior quarter of one side. `side` is 1
/// left, -1 right.
std::optional<Vector3d> condyle_center(const std::vector<const Part*>& mandibles, double middle,
                                       double side) {
  Box whole;
  for (const Part* part : mandibles) whole.add(bounding_box(part->mesh));
  const double hind = whole.high.y() - 0.3 * whole.size().y();
  const auto is_of_side = [&](const Vector3d& p) {
    return p.y() > hind && side * (p.x() - middle) > 15;
  };
  double top = -std::numeric_limits<double>::infinity();
  for (const Part* part : mandibles)
    for (const auto& p : part->mesh.vertices)
      if (is_of_side(p)) top = std::max(top, p.z());
  Box box;
  for (const Part* part : mandibles)
    for (const auto& p : part->mesh.vertices)
      if (is_of_side(p) && p.z() > top - 10) box.add(p);
  if (box.empty()) return std::nullopt;
  return box.center();
}

/// The point of the midline farthest forward and, times `up`, upward.
std::optional<Vector3d> incisal_point(const Part& part, double middle, double up) {
  std::optional<Vector3d> best;
  double most = -std::numeric_limits<double>::infinity();
  // There may be a gap between the central incisors: vertices near the plane are included.
  for (const auto& p : midline_points(part.mesh, middle, 5)) {
    const double reach = up * p.z() - p.y();
    if (reach > most) most = reach, best = Vector3d(middle, p.y(), p.z());
  }
  return best;
}

}  // namespace

std::vector<Vector3d> midline_points(const TriMesh& mesh, double middle, double near_mm) {
  std::vector<Vector3d> points;
  for (const auto& v : mesh.vertices)
    if (std::abs(v.x() - middle) <= near_mm) points.push_back(v);
  for (const auto& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vector3d &a = mesh.vertices[t[k]], &b = mesh.vertices[t[(k + 1) % 3]];
      if ((a.x() < middle) != (b.x() < middle))
        points.push_back(a + (middle - a.x()) / (b.x() - a.x()) * (b - a));
    }
  return points;
}

void estimate_landmarks(Case& patient) {
  std::vector<const Part*> mandibles;
  for (const auto& part : patient.parts)
    if (part.role == Role::mandible) mandibles.push_back(&part);
  if (mandibles.empty()) return;
  const auto known = [&](const char* name) { return patient.landmarks.find(name); };

  // The midline: from landmarks, else from the most symmetric part.
  double middle = 0;
  if (known("left_condyle") && known("right_condyle")) {
    middle = 0.5 * (known("left_condyle")->x() + known("right_condyle")->x());
  } else if (known("upper_incisal_point")) {
    middle = known("upper_incisal_point")->x();
  } else if (known("lower_incisal_point")) {
    middle = known("lower_incisal_point")->x();
  } else {
    const Part* part = patient.find(Role::skull);
    if (!part) part = patient.find(Role::maxilla);
    if (!part) part = mandibles.front();
    middle = bounding_box(part->mesh).center().x();
  }

  const auto estimate_condyle = [&](const std::string& name, double side) {
    if (patient.landmarks.find(name)) return;
    if (const auto p = condyle_center(mandibles, middle, side))
      adopt(patient, name, *p, "the top of the posterior end of the mandible");
  };
  estimate_condyle("left_condyle", 1);
  estimate_condyle("right_condyle", -1);
  for (const auto& [name, other] :
       {std::pair("left_condyle", "right_condyle"), std::pair("right_condyle", "left_condyle")}) {
    const auto opposite = known(other);
    if (known(name) || !opposite) continue;
    adopt(patient, name, {2 * middle - opposite->x(), opposite->y(), opposite->z()},
          "the other side, mirrored: the mandible has no condyle on this side");
  }

  if (!known("lower_incisal_point")) {
    const Part* part = patient.find(Role::lower_teeth);
    if (!part) part = mandibles.front();
    if (const auto p = incisal_point(*part, middle, 1))
      adopt(patient, "lower_incisal_point", *p,
            "the upper foremost point in the midline of " + part->name);
  }
  if (!known("upper_incisal_point")) {
    const Part* part = patient.find(Role::upper_teeth);
    if (!part) part = patient.find(Role::maxilla);
    if (!part) part = patient.find(Role::skull);
    if (!part) return;
    if (const auto p = incisal_point(*part, middle, -1))
      adopt(patient, "upper_incisal_point", *p,
            "the lower foremost point in the midline of " + part->name);
  }
}

}  // namespace condyle
