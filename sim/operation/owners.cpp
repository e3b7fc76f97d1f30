#include "sim/operation/owners.h"

#include <algorithm>
#include <cmath>

#include "engine/core/infinity.h"
#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The owner of a body's landmark, or the body itself where the case lacks the landmark.
BodyId owner_of_landmark(const Case& uncut, const OwnerFinder& finder, const std::string& name,
                         BodyId body) {
  const auto point = uncut.landmarks.find(name);
  return point ? finder.owner(body, *point) : finder.same(body);
}

/// The body with most of the teeth of an arch.
BodyId arch_body(const Case& uncut, const Case& operated, const OwnerFinder& finder, BodyId body,
                 Role role, const std::string& incisal_point) {
  if (!finder.was_cut(body)) return finder.same(body);
  std::map<BodyId, double> teeth;
  for (const Part& part : operated.parts)
    if (part.role == role && finder.origin(part.body) == body)
      teeth[part.body] += surface_area(part.mesh);
  if (teeth.empty()) return owner_of_landmark(uncut, finder, incisal_point, body);
  return std::max_element(teeth.begin(), teeth.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

}  // namespace

NearestSurface::Found NearestSurface::at(const Vector3d& p) const {
  Found best;
  for (const auto& [tree, value] : surfaces_) {
    // Beyond the nearest surface no other matters, unless the point is inside both.
    const SurfacePoint found = tree.signed_nearest(p, best.distance < 0 ? infinity : best.distance);
    if (found.triangle >= 0 && found.distance < best.distance) best = {found.distance, value};
  }
  return best;
}

int NearestSurface::of_most(std::span<const Vector3d> points, double* part) const {
  std::map<int, int> all, inside;
  int count = 0;
  for (const Vector3d& p : points) {
    const Found found = at(p);
    if (found.value < 0) continue;
    ++all[found.value];
    if (found.distance < 0) {
      ++inside[found.value];
      ++count;
    }
  }
  const bool root = 10 * count >= static_cast<int>(points.size()) && count > 0;
  const auto& votes = root ? inside : all;
  const auto most = std::max_element(
      votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most == votes.end()) return -1;
  if (part)
    *part = most->second / static_cast<double>(root ? count : static_cast<int>(points.size()));
  return most->first;
}

OwnerFinder::OwnerFinder(const Case& uncut, const Case& operated)
    : uncut_(uncut), operated_(operated) {
  for (int b = 0; b < operated.bodies.size(); ++b) {
    const Body& body = operated.bodies[BodyId{b}];
    const auto known = uncut.bodies.find(body.name);
    origin_.push_back(known ? *known : origin_[index_of(body.parent)]);
    if (!known) nearest_[origin_.back()];
  }
  for (const Part& part : operated.parts)
    if (const auto cut = nearest_.find(origin(part.body));
        cut != nearest_.end() && collides(part.role))
      cut->second.add(part.mesh, static_cast<int>(part.body));
}

bool OwnerFinder::was_cut(BodyId uncut_body) const { return nearest_.contains(uncut_body); }

BodyId OwnerFinder::owner(BodyId uncut_body, const Vector3d& point) const {
  if (const auto cut = nearest_.find(uncut_body); cut != nearest_.end() && !cut->second.empty())
    return BodyId{cut->second.at(point).value};
  return same(uncut_body);
}

BodyId OwnerFinder::same(BodyId uncut_body) const {
  return operated_.bodies.find(uncut_.bodies[uncut_body].name).value_or(cranium_body);
}

namespace {

/// The bodies that own landmarks before cuts.
LandmarkOwners uncut_owners(const Case& uncut) {
  constexpr double near_mm = 3;
  NearestSurface bones, faces;
  for (const Part& part : uncut.parts) {
    if (collides(part.role)) bones.add(part.mesh, static_cast<int>(part.body));
    if (part.role == Role::face) faces.add(part.mesh, 0);
  }
  LandmarkOwners owners = default_landmark_owners(uncut.jaw);
  std::erase_if(owners, [&](const auto& item) { return !uncut.landmarks.find(item.first); });
  for (const auto& [name, point] : uncut.landmarks.points) {
    if (name.starts_with("upper_") || name.starts_with("lower_")) {  // on a tooth
      owners[name] = name.starts_with("upper_") ? uncut.jaw.upper_arch : uncut.jaw.lower_arch;
    } else if (!owners.contains(name)) {
      const auto bone = bones.at(point);
      if (bone.value < 0 || bone.distance > near_mm) continue;
      if (!faces.empty() && std::abs(faces.at(point).distance) < bone.distance) continue;
      owners[name] = BodyId{bone.value};
    }
  }
  return owners;
}

}  // namespace

LandmarkOwners landmark_owners(const Case& uncut, const OwnerFinder& finder) {
  LandmarkOwners owners = uncut_owners(uncut);
  for (auto& [name, body] : owners) body = finder.owner(body, uncut.landmarks.points.at(name));
  return owners;
}

std::set<std::string> resected_landmarks(const Case& uncut, const OwnerFinder& finder,
                                         const Operated& operated) {
  std::map<BodyId, NearestSurface> resected, remaining;  // by body of the uncut case
  for (const Resection& resection : operated.resections)
    for (const Part& whole : uncut.parts)
      if (whole.name == resection.origin.part)
        for (const Part& part : resection.parts)
          if (collides(part.role)) resected[whole.body].add(part.mesh, 0);
  std::set<std::string> names;
  if (resected.empty()) return names;
  for (const Part& part : operated.patient.parts)
    if (const BodyId body = finder.origin(part.body);
        collides(part.role) && resected.contains(body))
      remaining[body].add(part.mesh, 0);
  for (const auto& [name, body] : uncut_owners(uncut)) {
    const Vector3d& point = uncut.landmarks.points.at(name);
    if (const auto found = resected.find(body);
        found != resected.end() &&
        found->second.at(point).distance < remaining[body].at(point).distance)
      names.insert(name);
  }
  return names;
}

JawBodies jaw_bodies(const Case& uncut, const Case& operated, const OwnerFinder& finder) {
  const JawBodies& jaw = uncut.jaw;
  return {.upper_arch = arch_body(uncut, operated, finder, jaw.upper_arch, Role::upper_teeth,
                                  "upper_incisal_point"),
          .lower_arch = arch_body(uncut, operated, finder, jaw.lower_arch, Role::lower_teeth,
                                  "lower_incisal_point"),
          .left_condyle = owner_of_landmark(uncut, finder, "left_condyle", jaw.left_condyle),
          .right_condyle = owner_of_landmark(uncut, finder, "right_condyle", jaw.right_condyle)};
}

std::vector<MuscleOwners> muscle_owners(const Case& uncut, const OwnerFinder& finder) {
  const auto owner = [&](MuscleBody body, const Vector3d& point) {
    if (body == MuscleBody::mandible) return finder.owner(uncut.jaw.lower_arch, point);
    return body == MuscleBody::cranium ? finder.owner(cranium_body, point) : cranium_body;
  };
  std::vector<MuscleOwners> owners;
  for (const Muscle& muscle : uncut.muscles)
    owners.push_back(
        {owner(muscle.origin_body, muscle.origin), owner(muscle.insertion_body, muscle.insertion)});
  return owners;
}

}  // namespace condyle
