#include "render/window/movable.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The first of skull, maxilla and upper teeth that is there.
std::optional<std::size_t> part_that_names_skull(std::span<const Part> parts) {
  for (const Role role : {Role::skull, Role::maxilla, Role::upper_teeth})
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i].role == role) return i;
  return std::nullopt;
}

}  // namespace

std::vector<MovableBody> movable_bodies(std::span<const Part> parts) {
  std::vector<MovableBody> bodies;
  const auto jaw = std::find_if(parts.begin(), parts.end(),
                                [](const Part& part) { return part.role == Role::mandible; });
  if (jaw != parts.end()) {
    Box box;
    for (const auto& part : parts)
      if (part.role == Role::mandible)
        for (const auto& v : part.mesh.vertices) box.add(v);
    bodies.push_back({.part = static_cast<std::size_t>(jaw - parts.begin()),
                      .free = std::nullopt,
                      .carrier = Body::cranium,
                      .center = box.center()});
    if (const auto skull = part_that_names_skull(parts))
      bodies.push_back({.part = *skull,
                        .free = std::nullopt,
                        .skull = true,
                        .center = bounding_box(parts[*skull].mesh).center()});
  }
  const auto free = free_parts(parts);
  for (std::size_t f = 0; f < free.size(); ++f)
    bodies.push_back({.part = free[f],
                      .free = f,
                      .carrier = parts[free[f]].carrier,
                      .center = bounding_box(parts[free[f]].mesh).center()});
  return bodies;
}

std::optional<std::size_t> movable_body_of(std::span<const MovableBody> bodies,
                                           std::span<const Part> parts, std::size_t part) {
  if (part >= parts.size()) return std::nullopt;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].free
            ? bodies[i].part == part
            : body_of(parts[part].role) == (bodies[i].skull ? Body::cranium : Body::mandible))
      return i;
  return std::nullopt;
}

bool same(const std::optional<Pose>& a, const std::optional<Pose>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->t == b->t && a->R.coeffs() == b->R.coeffs();
}

std::optional<Pose> Hands::X_CM_wanted() const {
  return X_RM ? skull.value_or(Pose{}).inverse() * *X_RM : mandible;
}

Pose Hands::X_RC(const Pose& X_CM) const {
  return X_RM ? *X_RM * X_CM.inverse() : skull.value_or(Pose{});
}

std::optional<Pose> Hands::of(const MovableBody& body) const {
  if (body.skull) return skull;
  if (!body.free) return X_CM_wanted();
  return *body.free < free.size() ? free[*body.free] : std::nullopt;
}

void Hands::move(const MovableBody& body, const Pose& wanted, const Pose& X_CM) {
  if (body.skull) {
    if (!X_RM) X_RM = X_RC(X_CM) * X_CM;
    skull = wanted;
  } else if (body.free) {
    if (free.size() <= *body.free) free.resize(*body.free + 1);
    free[*body.free] = wanted;
  } else {
    release_jaw(X_CM);
    mandible = wanted;
  }
}

void Hands::hold_jaw(const Pose& X_CM) {
  X_RM.reset();
  mandible = X_CM;
}

void Hands::put_back(const MovableBody& body, const Pose& X_CM) {
  if (body.skull) {
    skull.reset();
    X_RM.reset();
  } else if (!body.free) {
    release_jaw(X_CM);
  } else if (*body.free < free.size()) {
    free[*body.free].reset();
  }
}

void Hands::release_jaw(const Pose& X_CM) {
  if (X_RM) skull = X_RC(X_CM);
  mandible.reset();
  X_RM.reset();
}

bool Hands::same_jaws(const Hands& other) const {
  return same(mandible, other.mandible) && same(skull, other.skull) && same(X_RM, other.X_RM);
}

bool Hands::operator==(const Hands& other) const {
  const std::size_t count = std::max(free.size(), other.free.size());
  const auto at = [](const Hands& hands, std::size_t i) {
    return i < hands.free.size() ? hands.free[i] : std::nullopt;
  };
  for (std::size_t i = 0; i < count; ++i)
    if (!same(at(*this, i), at(other, i))) return false;
  return same_jaws(other);
}

Placement placement_of(const Pose& pose, const Vector3d& center) {
  const Eigen::Matrix3d R = pose.R.toRotationMatrix();
  const double pitch = std::atan2(R(2, 1), R(2, 2)),
               roll = std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))),
               yaw = std::atan2(R(1, 0), R(0, 0));
  return {.shift_mm = pose * center - center,
          .turn_deg = Vector3d(pitch, roll, yaw) * 180 / std::numbers::pi};
}

Pose pose_at(const Placement& placement, const Vector3d& center) {
  const Vector3d a = placement.turn_deg * std::numbers::pi / 180;
  const Eigen::Quaterniond R = Eigen::AngleAxisd(a.z(), Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(a.y(), Vector3d::UnitY()) *
                               Eigen::AngleAxisd(a.x(), Vector3d::UnitX());
  return {R, center + placement.shift_mm - R * center};
}

Pose carrier_pose(const MovableBody& body, const Pose& X_CM) {
  return body.free && body.carrier == Body::mandible ? X_CM : Pose{};
}

}  // namespace condyle
