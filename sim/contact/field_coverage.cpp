#include "sim/contact/field_coverage.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

using Eigen::Vector3d;

// A wall is thin where the field a spacing below the surface is not inside.
constexpr double thin_fraction = 0.1;
constexpr double flat = 0.9;  // cosine
constexpr std::size_t stride = 7;

}  // namespace

FieldCoverage field_coverage(const Box& surface, const std::optional<Box>& region) {
  FieldCoverage coverage;
  coverage.box = surface;
  if (!region) return coverage;
  Box rest = surface;  // excluding the parts outside the region
  for (int axis = 0; axis < 3; ++axis) {
    if (rest.low[axis] < region->low[axis]) {
      Box below = rest;
      below.high[axis] = std::min(rest.high[axis], region->low[axis]);
      coverage.outside.push_back(below);
      rest.low[axis] = below.high[axis];
    }
    if (rest.high[axis] > region->high[axis] && rest.low[axis] < rest.high[axis]) {
      Box above = rest;
      above.low[axis] = std::max(rest.low[axis], region->high[axis]);
      coverage.outside.push_back(above);
      rest.high[axis] = above.low[axis];
    }
    coverage.uncovered = !(rest.low[axis] < rest.high[axis]);
    if (coverage.uncovered) break;
  }
  return coverage;
}

bool is_thin(const ContactSurface& body) {
  const SurfaceSamples& samples = body.samples;
  const double below_mm = body.field.settings().spacing_mm;
  std::size_t thin = 0, all = 0;
  for (std::size_t i = 0; i < samples.points.size(); i += stride) {
    if (samples.spread[i] < flat) continue;
    ++all;
    thin += body.field.at(samples.points[i] - below_mm * samples.normals[i]).distance_mm >
            -0.25 * below_mm;
  }
  return static_cast<double>(thin) > thin_fraction * static_cast<double>(all);
}

bool boxes_meet(const Box& a, const Box& b, const Pose& X_AB, double within_mm) {
  const Eigen::Matrix3d R = X_AB.R.toRotationMatrix();
  const Vector3d half_a = 0.5 * a.size(), half_b = 0.5 * b.size();
  const Vector3d between = X_AB * b.center() - a.center();
  const auto parted = [&](const Vector3d& axis) {
    const double length = axis.norm();
    return length > 1e-9 && std::abs(between.dot(axis)) - half_a.dot(axis.cwiseAbs()) -
                                    half_b.dot((R.transpose() * axis).cwiseAbs()) >
                                within_mm * length;
  };
  for (int i = 0; i < 3; ++i) {
    const Vector3d unit = Vector3d::Unit(i);
    if (parted(unit) || parted(R.col(i))) return false;
    for (int k = 0; k < 3; ++k)
      if (parted(unit.cross(R.col(k)))) return false;
  }
  return true;
}

}  // namespace condyle
