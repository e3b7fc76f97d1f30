#include "sim/plan/case_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "engine/core/hash.h"

namespace condyle {
namespace {

std::uint64_t shape_hash(const TriMesh& mesh) {
  const std::uint64_t counts[2] = {mesh.vertices.size(), mesh.triangles.size()};
  std::uint64_t h = hash_values(std::span<const std::uint64_t>(counts));
  h = hash_bytes(mesh.vertices.data(), mesh.vertices.size() * sizeof(Eigen::Vector3d), h);
  return hash_bytes(mesh.triangles.data(), mesh.triangles.size() * sizeof(Eigen::Vector3i), h);
}

bool same_bits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  for (int i = 0; i < 3; ++i)
    if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) return false;
  return true;
}

const PartGeometry* part_named(const CaseGeometry& geometry, const std::string& name) {
  const auto found = std::find_if(geometry.parts.begin(), geometry.parts.end(),
                                  [&](const PartGeometry& part) { return part.name == name; });
  return found == geometry.parts.end() ? nullptr : &*found;
}

}  // namespace

bool CaseGeometry::operator==(const CaseGeometry& other) const {
  return name == other.name && parts == other.parts &&
         std::equal(landmarks.points.begin(), landmarks.points.end(),
                    other.landmarks.points.begin(), other.landmarks.points.end(),
                    [](const auto& a, const auto& b) {
                      return a.first == b.first && same_bits(a.second, b.second);
                    });
}

CaseGeometry geometry_of(const Case& patient) {
  CaseGeometry geometry{.name = patient.name, .parts = {}, .landmarks = patient.landmarks};
  for (const auto& part : patient.parts)
    if (collides(part.role) || part.role == Role::face)
      geometry.parts.push_back({part.name, shape_hash(part.mesh)});
  return geometry;
}

std::string geometry_hash(const CaseGeometry& geometry) {
  std::uint64_t h = hash_start;
  for (const PartGeometry& part : geometry.parts)
    h = hash_bytes(&part.hash, sizeof part.hash, hash_bytes(part.name.data(), part.name.size(), h));
  for (const auto& [name, point] : geometry.landmarks.points)
    h = hash_bytes(point.data(), 3 * sizeof(double), hash_bytes(name.data(), name.size(), h));
  return fmt::format("{:016x}", h);
}

CaseComparison compare_geometry(const CaseGeometry& planned, const CaseGeometry& present) {
  CaseComparison result;
  for (const auto& part : planned.parts) {
    const PartGeometry* now = part_named(present, part.name);
    if (!now)
      result.differences.push_back(part.name + " is missing");
    else if (now->hash != part.hash)
      result.differences.push_back(part.name + " has another shape");
  }
  for (const auto& part : present.parts)
    if (!part_named(planned, part.name)) result.differences.push_back(part.name + " is new");
  if (!result.differences.empty()) {
    result.match = CaseMatch::other_case;
    return result;
  }
  for (const auto& [name, point] : planned.landmarks.points) {
    const auto now = present.landmarks.find(name);
    if (!now)
      result.differences.push_back(name + " is missing");
    else if (!same_bits(*now, point))
      result.differences.push_back(
          fmt::format("{} moved by {:.3g} mm", name, (*now - point).norm()));
  }
  for (const auto& [name, point] : present.landmarks.points)
    if (!planned.landmarks.find(name)) result.differences.push_back(name + " is new");
  if (!result.differences.empty()) result.match = CaseMatch::landmarks_edited;
  return result;
}

}  // namespace condyle
