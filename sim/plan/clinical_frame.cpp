#include "sim/plan/clinical_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/core/error.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Least height of the triangle that spans the midsagittal plane, and least distance from orbitales
/// to porions: closer points leave the direction to their errors.
constexpr double least_span_mm = 5;

std::optional<Vector3d> midpoint(const Landmarks& landmarks, const std::string& name) {
  const auto left = landmarks.find("left_" + name), right = landmarks.find("right_" + name);
  if (!left || !right) return std::nullopt;
  return 0.5 * (*left + *right);
}

/// Mean of the sides that exist: in the projection on the midsagittal plane one is enough.
std::optional<Vector3d> either_side(const Landmarks& landmarks, const std::string& name) {
  if (const auto both = midpoint(landmarks, name)) return both;
  if (const auto left = landmarks.find("left_" + name)) return left;
  return landmarks.find("right_" + name);
}

struct Midsagittal {
  Vector3d left, origin;
  std::vector<std::string> notes;
};

/// A point of the midsagittal plane and its replacement.
struct MidlinePoint {
  const char* name;
  const char* replacement;
  bool paired;
};

constexpr std::array<MidlinePoint, 3> midline_points = {
    {{"nasion", "glabella", false}, {"basion", "sella", false}, {"porion", "condyle", true}}};

std::string missing_text(const MidlinePoint& point) {
  const std::string name = point.name, other = point.replacement;
  return point.paired ? fmt::format(
                            "the landmarks left_{0} and right_{0} (or left_{1} and "
                            "right_{1})",
                            name, other)
                      : fmt::format("the landmark {} (or {})", name, other);
}

/// Absent, with the reason in `problem`, if landmarks are missing.
std::optional<Midsagittal> midsagittal(const Landmarks& landmarks, std::string& problem) {
  Midsagittal plane;
  std::array<Vector3d, 3> points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const MidlinePoint& point = midline_points[i];
    const auto find = [&](const char* name) {
      return point.paired ? midpoint(landmarks, name) : landmarks.find(name);
    };
    auto found = find(point.name);
    if (!found && (found = find(point.replacement)))
      plane.notes.push_back(
          fmt::format("midsagittal plane: {} for {}", point.replacement, point.name));
    if (!found) {
      problem = "the midsagittal plane needs " + missing_text(point);
      return std::nullopt;
    }
    points[i] = *found;
  }
  plane.origin = points[0];
  const Vector3d a = points[1] - points[0], b = points[2] - points[0], normal = a.cross(b);
  const double longest = std::max({a.norm(), b.norm(), (a - b).norm()});
  if (!(normal.norm() >= least_span_mm * longest))
    throw InputError(fmt::format(
        "the midsagittal plane is undetermined: {}, {} and the midpoint of the {}s lie in line",
        midline_points[0].name, midline_points[1].name, midline_points[2].name));
  plane.left = (normal.x() < 0 ? -normal : normal).normalized();
  return plane;
}

void check_sides(const Landmarks& landmarks, const Vector3d& left) {
  for (const std::string name : {"porion", "condyle", "orbitale"}) {
    const auto a = landmarks.find("left_" + name), b = landmarks.find("right_" + name);
    if (a && b && (*a - *b).dot(left) < 0)
      throw InputError(fmt::format(
          "left_{0} lies to the right of right_{0}: the sides of the landmarks are exchanged, or "
          "the case is not in LPS",
          name));
  }
}

Vector3d required_side(const Landmarks& landmarks, const std::string& name) {
  if (const auto found = either_side(landmarks, name)) return *found;
  throw InputError(fmt::format(
      "the Frankfort plane needs the landmarks left_{0} and right_{0} (or one of them); natural "
      "head position does not",
      name));
}

}  // namespace

std::string horizontal_name(Horizontal horizontal) {
  return horizontal == Horizontal::frankfort ? "frankfort" : "natural_head_position";
}

ClinicalFrame clinical_frame(const Landmarks& landmarks, const HeadReference& reference) {
  std::string problem;
  const auto plane = midsagittal(landmarks, problem);
  ClinicalFrame frame;
  if (reference.horizontal == Horizontal::natural_head_position) {
    const Eigen::Quaterniond R_CN = reference.R_NC.conjugate();
    frame.up = (R_CN * Vector3d::UnitZ()).normalized();
    Vector3d left = plane ? plane->left : Vector3d(R_CN * Vector3d::UnitX());
    left -= left.dot(frame.up) * frame.up;
    if (!(left.norm() > 0.5))  // tilted by more than 60 degrees
      throw InputError("natural head position: its vertical lies across the midsagittal plane");
    frame.left = left.normalized();
    frame.back = frame.up.cross(frame.left);
    if (plane) {
      frame.origin = plane->origin;
      frame.notes = plane->notes;
    } else {
      frame.notes.push_back(problem + "; left is that of the given rotation");
    }
  } else {
    if (!plane) throw InputError(problem);
    frame.left = plane->left;
    Vector3d back = required_side(landmarks, "porion") - required_side(landmarks, "orbitale");
    back -= back.dot(frame.left) * frame.left;
    if (!(back.norm() >= least_span_mm))
      throw InputError("the Frankfort plane is undetermined: porion and orbitale coincide");
    frame.back = back.normalized();
    frame.up = frame.left.cross(frame.back);
    frame.origin = plane->origin;
    frame.notes = plane->notes;
  }
  check_sides(landmarks, frame.left);
  if (frame.back.y() <= 0 || frame.up.z() <= 0)
    throw InputError(fmt::format(
        "{}: the patient's back or up points against the case's axes (LPS): landmarks are "
        "exchanged, or the case is not in LPS",
        horizontal_name(reference.horizontal)));
  return frame;
}

}  // namespace condyle
