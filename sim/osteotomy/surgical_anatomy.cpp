#include "sim/osteotomy/surgical_anatomy.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Axes of a jaw without a skull: the line from the condyles to the lower incisal point falls 28.5
/// degrees to the Frankfort plane, as on the built-in patient.
ClinicalFrame jaw_frame(const Landmarks& landmarks) {
  constexpr double fall = 28.5 * 3.14159265358979323846 / 180;
  const auto left = landmarks.find("left_condyle"), right = landmarks.find("right_condyle"),
             incisal = landmarks.find("lower_incisal_point");
  ClinicalFrame frame;
  frame.left = (*left - *right).normalized();
  frame.origin = 0.5 * (*left + *right);
  Vector3d forward = *incisal - frame.origin;
  forward = (forward - forward.dot(frame.left) * frame.left).normalized();
  const Vector3d up = forward.cross(frame.left);  // at right angles to the falling line
  frame.back = -(std::cos(fall) * forward + std::sin(fall) * up);
  frame.up = frame.left.cross(frame.back);
  frame.notes = {
      "the case lacks landmarks of the skull: its axes are estimated from condyles and lower "
      "incisal point"};
  return frame;
}

ClinicalFrame frame_of(const Landmarks& landmarks) {
  try {
    return clinical_frame(landmarks);
  } catch (const InputError&) {
    for (const char* name : {"left_condyle", "right_condyle", "lower_incisal_point"})
      if (!landmarks.find(name)) throw;
    return jaw_frame(landmarks);
  }
}

}  // namespace

SurgicalAnatomy::SurgicalAnatomy(const Case& patient, const Part& bone)
    : patient_(patient), frame_(frame_of(patient.landmarks)), bone_(bone.mesh) {
  notes = frame_.notes;
  for (auto& p : bone_.vertices) p = local(p);
}

std::optional<Vector3d> SurgicalAnatomy::find(const std::string& landmark) const {
  const auto found = patient_.landmarks.find(landmark);
  if (!found) return std::nullopt;
  return local(*found);
}

Vector3d SurgicalAnatomy::need(const std::string& landmark) const {
  if (const auto found = find(landmark)) return *found;
  throw InputError("the case lacks the landmark " + landmark);
}

std::optional<Vector3d> SurgicalAnatomy::find_middle(const std::string& paired) const {
  const auto left = find("left_" + paired), right = find("right_" + paired);
  if (!left || !right) return std::nullopt;
  return Vector3d(0.5 * (*left + *right));
}

std::vector<Vector3d> SurgicalAnatomy::tooth_points(int fdi) const {
  std::vector<Vector3d> points;
  for (const auto& part : patient_.parts)
    for (const auto& tooth : part.teeth) {
      if (tooth.fdi != fdi) continue;
      for (int t = 0; t < tooth.triangle_count; ++t)
        for (const int v : part.mesh.triangles[tooth.first_triangle + t])
          points.push_back(local(part.mesh.vertices[v]));
    }
  return points;
}

std::optional<Vector3d> SurgicalAnatomy::tooth_middle(int fdi) const {
  Box box;
  for (const auto& p : tooth_points(fdi)) box.add(p);
  if (box.empty()) return std::nullopt;
  return box.center();
}

std::vector<SurgicalAnatomy::Danger> SurgicalAnatomy::canal_dangers(BodyId body,
                                                                    double margin_mm) const {
  std::vector<Danger> dangers;
  for (const auto& canal : patient_.canals)
    if (canal.body == body)
      for (const auto& p : canal.points)
        dangers.push_back({local(p), 0.5 * canal.diameter_mm + margin_mm});
  return dangers;
}

Plane SurgicalAnatomy::plane(const Vector3d& point, const Vector3d& normal) const {
  return plane_through(frame_.origin + frame_.vector(point), frame_.vector(normal));
}

Region SurgicalAnatomy::above(const Vector3d& point, const Vector3d& normal, int wall) const {
  return Region::above(plane(point, normal), wall);
}

Region SurgicalAnatomy::sheet(std::span<const Vector3d> polyline, const Vector3d& direction,
                              const Vector3d& side, int first_wall) const {
  std::vector<Vector3d> points;
  for (const auto& p : polyline) points.push_back(frame_.origin + frame_.vector(p));
  return beyond_sheet(points, frame_.vector(direction), frame_.vector(side), first_wall);
}

CutStation SurgicalAnatomy::station(std::string parameter, const Vector3d& at,
                                    const Vector3d& per_unit) const {
  return {std::move(parameter), frame_.origin + frame_.vector(at), frame_.vector(per_unit)};
}

std::vector<Plane> SurgicalAnatomy::box(const Vector3d& low, const Vector3d& high) const {
  std::vector<Plane> planes;
  for (int axis = 0; axis < 3; ++axis) {
    planes.push_back(plane(high, Vector3d::Unit(axis)));
    planes.push_back(plane(low, -Vector3d::Unit(axis)));
  }
  return planes;
}

std::vector<double> SurgicalAnatomy::crossings(Side side, double y, double z) const {
  std::vector<double> found;
  const double sign = sign_of(side);
  for (const auto& t : bone_.triangles) {
    const Vector3d &a = bone_.vertices[t[0]], &b = bone_.vertices[t[1]], &c = bone_.vertices[t[2]];
    if (std::min({a.y(), b.y(), c.y()}) > y || std::max({a.y(), b.y(), c.y()}) < y ||
        std::min({a.z(), b.z(), c.z()}) > z || std::max({a.z(), b.z(), c.z()}) < z)
      continue;
    const Vector3d u = b - a, v = c - a;
    const double area = u.y() * v.z() - u.z() * v.y();
    if (std::abs(area) < 1e-12) continue;
    const double s = ((y - a.y()) * v.z() - (z - a.z()) * v.y()) / area;
    const double r = (u.y() * (z - a.z()) - u.z() * (y - a.y())) / area;
    if (s < 0 || r < 0 || s + r > 1) continue;
    const double x = sign * (a.x() + s * u.x() + r * v.x());
    if (x > 5) found.push_back(x);
  }
  std::sort(found.begin(), found.end(), std::greater<>());
  // A line through an edge crosses both of its triangles.
  found.erase(std::unique(found.begin(), found.end(),
                          [](double a, double b) { return std::abs(a - b) < 1e-6; }),
              found.end());
  return found;
}

std::optional<SurgicalAnatomy::Range> SurgicalAnatomy::section(Side side, int axis, double at,
                                                               int coordinate,
                                                               double least_x) const {
  std::optional<Range> range;
  for (const auto& t : bone_.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vector3d &a = bone_.vertices[t[k]], &b = bone_.vertices[t[(k + 1) % 3]];
      if ((a[axis] < at) == (b[axis] < at)) continue;
      const Vector3d p = a + (at - a[axis]) / (b[axis] - a[axis]) * (b - a);
      if (sign_of(side) * p.x() <= least_x) continue;
      if (!range) range = Range{p, p, p[coordinate], p[coordinate]};
      if (p[coordinate] < range->low) range->low_at = p, range->low = p[coordinate];
      if (p[coordinate] > range->high) range->high_at = p, range->high = p[coordinate];
    }
  return range;
}

}  // namespace condyle
