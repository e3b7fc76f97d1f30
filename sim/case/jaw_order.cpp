#include "sim/case/jaw_order.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <vector>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "sim/case/import_checks.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// Area centroids of one patient's jaws are 10 to 40 mm apart in height, those of the crowns 5 to 15
// mm.
constexpr double certain_bones_mm = 5, certain_teeth_mm = 2;
constexpr double incisal_edges_mm = 15;  // deepest overbites are some 12 mm

bool is_upper_bone(Role role) { return role == Role::maxilla || role == Role::skull; }

template <class Matches>
std::vector<const Part*> parts_of(const Case& patient, const Matches& matches) {
  std::vector<const Part*> parts;
  for (const auto& part : patient.parts)
    if (matches(part.role)) parts.push_back(&part);
  return parts;
}

std::string file_of(const ImportRequest& request, const Part& part) {
  for (const auto& source : request.files)
    if (source.role == part.role) return source.file.string();
  return part.name;
}

Box box_of(const std::vector<const Part*>& parts) {
  Box box;
  for (const Part* part : parts) box.add(bounding_box(part->mesh));
  return box;
}

/// Mean height of the surfaces within the box, weighted by area; none where it holds none.
std::optional<double> mean_height(const std::vector<const Part*>& parts, const Box& within) {
  double sum = 0, area = 0;
  for (const Part* part : parts)
    for (const auto& t : part->mesh.triangles) {
      const Vector3d &a = part->mesh.vertices[t[0]], &b = part->mesh.vertices[t[1]],
                     &c = part->mesh.vertices[t[2]];
      const Vector3d middle = (a + b + c) / 3;
      if (!within.contains(middle, 0)) continue;
      const double twice = (b - a).cross(c - a).norm();
      sum += twice * middle.z();
      area += twice;
    }
  if (!(area > 0)) return std::nullopt;
  return sum / area;
}

/// Height of the upper surfaces above the lower ones where both have some: in the front half of the
/// area in which their boxes overlap, seen from above. None where they do not overlap.
std::optional<double> upper_above_lower_mm(const std::vector<const Part*>& upper,
                                           const std::vector<const Part*>& lower) {
  if (upper.empty() || lower.empty()) return std::nullopt;
  const Box a = box_of(upper), b = box_of(lower);
  Box shared;
  shared.low = a.low.cwiseMax(b.low);
  shared.high = a.high.cwiseMin(b.high);
  if (shared.low.x() >= shared.high.x() || shared.low.y() >= shared.high.y()) return std::nullopt;
  shared.high.y() = 0.5 * (shared.low.y() + shared.high.y());
  shared.low.z() = std::min(a.low.z(), b.low.z());
  shared.high.z() = std::max(a.high.z(), b.high.z());
  const auto upper_z = mean_height(upper, shared), lower_z = mean_height(lower, shared);
  if (!upper_z || !lower_z) return std::nullopt;
  return *upper_z - *lower_z;
}

std::string option(Role role, const std::string& file) {
  return fmt::format("--{} {}", role_name(role), file);
}

/// Names both files and the options to write.
[[noreturn]] void refuse_exchanged(const ImportRequest& request, const Part& upper,
                                   const Part& lower, double above_mm) {
  const std::string upper_file = file_of(request, upper), lower_file = file_of(request, lower);
  throw InputError(
      lower_file, "",
      fmt::format("is given as {} but lies {:.0f} mm above {}, which is given as {}: the two are "
                  "exchanged; write {} {}",
                  role_name(lower.role), -above_mm, upper_file, role_name(upper.role),
                  option(upper.role, lower_file), option(lower.role, upper_file)));
}

}  // namespace

void check_jaw_order(Case& patient, const ImportRequest& request) {
  const auto upper_bones = parts_of(patient, is_upper_bone);
  const auto mandibles = parts_of(patient, [](Role role) { return role == Role::mandible; });
  const auto bones = upper_above_lower_mm(upper_bones, mandibles);
  if (bones && *bones < -certain_bones_mm)
    refuse_exchanged(request, *upper_bones.front(), *mandibles.front(), *bones);

  const auto upper_teeth = parts_of(patient, [](Role role) { return role == Role::upper_teeth; });
  const auto lower_teeth = parts_of(patient, [](Role role) { return role == Role::lower_teeth; });
  const auto teeth = upper_above_lower_mm(upper_teeth, lower_teeth);
  if (teeth && *teeth < -certain_teeth_mm)
    refuse_exchanged(request, *upper_teeth.front(), *lower_teeth.front(), *teeth);
  if (teeth && *teeth < certain_teeth_mm)
    patient.notes.push_back(fmt::format(
        "the upper and the lower teeth lie at the same height (within {:.1f} mm): check "
        "that {} and {} are not exchanged, and that both are of this patient",
        std::abs(*teeth), file_of(request, *upper_teeth.front()),
        file_of(request, *lower_teeth.front())));

  const auto upper_edge = patient.landmarks.find("upper_incisal_point");
  const auto lower_edge = patient.landmarks.find("lower_incisal_point");
  if (upper_edge && lower_edge && lower_edge->z() > upper_edge->z() + incisal_edges_mm)
    throw InputError(
        request.landmarks, "lower_incisal_point",
        fmt::format("lies {:.0f} mm above upper_incisal_point, which no bite allows: exchange the "
                    "two points, or the files of the upper and the lower jaw",
                    lower_edge->z() - upper_edge->z()));
}

}  // namespace condyle
