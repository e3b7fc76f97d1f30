#include "render/window/view/movable.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The part that names a body: bone before teeth, of the skull in this order.
std::optional<std::size_t> naming_part(std::span<const Part> parts, BodyId body) {
  for (const Role role : {Role::skull, Role::maxilla, Role::mandible, Role::segment,
                          Role::transplant, Role::upper_teeth, Role::lower_teeth})
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (parts[i].role == role && parts[i].body == body) return i;
  return std::nullopt;
}

}  // namespace

bool can_be_cut(const Part& part) {
  return collides(part.role) && !is_teeth(part.role) && part.role != Role::transplant;
}

std::vector<MovableBody> movable_bodies(std::span<const Part> parts, const BodyTree& bodies) {
  std::vector<MovableBody> jaws, others;
  for (int b = 1; b < bodies.size(); ++b) {
    const BodyId body{b};
    const auto name = naming_part(parts, body);
    const bool jaw = bodies.moved_by_motion(body);
    if (!name || (jaw && is_teeth(parts[*name].role))) continue;
    Box box;
    for (const auto& part : parts)
      if (part.body == body && collides(part.role) && !(jaw && is_teeth(part.role)))
        box.add(bounding_box(part.mesh));
    (jaw ? jaws : others)
        .push_back({.part = *name,
                    .body = body,
                    .parent = bodies[body].parent,
                    .follows_motion = jaw,
                    .center = box.center()});
  }
  if (const auto skull = naming_part(parts, cranium_body); skull && !jaws.empty())
    jaws.push_back({.part = *skull,
                    .body = cranium_body,
                    .follows_motion = false,
                    .center = bounding_box(parts[*skull].mesh).center()});
  jaws.insert(jaws.end(), others.begin(), others.end());
  return jaws;
}

std::optional<std::size_t> movable_body_of(std::span<const MovableBody> bodies,
                                           std::span<const Part> parts, std::size_t part) {
  if (part >= parts.size() || !is_rigid(parts[part].role)) return std::nullopt;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].body == parts[part].body) return i;
  return std::nullopt;
}

bool same(const std::optional<Pose>& a, const std::optional<Pose>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->t == b->t && a->R.coeffs() == b->R.coeffs();
}

std::optional<Pose> Hands::at(BodyId body) const {
  return index_of(body) < X_PB.size() ? X_PB[index_of(body)] : std::nullopt;
}

void Hands::set(BodyId body, const std::optional<Pose>& target) {
  if (X_PB.size() <= index_of(body)) X_PB.resize(index_of(body) + 1);
  X_PB[index_of(body)] = target;
}

std::optional<Pose> Hands::X_CM_target() const {
  return X_RM ? at(cranium_body).value_or(Pose{}).inverse() * *X_RM : at(jaw);
}

Pose Hands::X_RC(const Pose& X_CM) const {
  return X_RM ? *X_RM * X_CM.inverse() : at(cranium_body).value_or(Pose{});
}

std::optional<Pose> Hands::of(const MovableBody& body) const {
  return body.body == jaw ? X_CM_target() : at(body.body);
}

void Hands::move(const MovableBody& body, const Pose& target, const Pose& X_CM) {
  if (body.is_skull()) {
    if (!X_RM) X_RM = X_RC(X_CM) * X_CM;
  } else if (body.body == jaw) {
    release_jaw(X_CM);
  }
  set(body.body, target);
}

void Hands::hold_jaw(const Pose& X_CM) {
  X_RM.reset();
  set(jaw, X_CM);
}

void Hands::put_back(const MovableBody& body, const Pose& X_CM) {
  if (body.body == jaw) return release_jaw(X_CM);
  set(body.body, std::nullopt);
  if (body.is_skull()) X_RM.reset();
}

void Hands::release_jaw(const Pose& X_CM) {
  if (X_RM) set(cranium_body, X_RC(X_CM));
  set(jaw, std::nullopt);
  X_RM.reset();
}

bool Hands::same_jaws(const Hands& other) const {
  return same(at(jaw), other.at(jaw)) && same(at(cranium_body), other.at(cranium_body)) &&
         same(X_RM, other.X_RM);
}

bool Hands::operator==(const Hands& other) const {
  const std::size_t count = std::max(X_PB.size(), other.X_PB.size());
  for (std::size_t b = 0; b < count; ++b)
    if (const BodyId body{static_cast<int>(b)}; !same(at(body), other.at(body))) return false;
  return jaw == other.jaw && same(X_RM, other.X_RM);
}

Placement placement_of(const Pose& pose, const Vector3d& center, const Eigen::Matrix3d& axes) {
  const Eigen::Matrix3d R = axes.transpose() * pose.R.toRotationMatrix() * axes;
  const double pitch = std::atan2(R(2, 1), R(2, 2)),
               roll = std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))),
               yaw = std::atan2(R(1, 0), R(0, 0));
  return {.shift_mm = axes.transpose() * (pose * center - center),
          .turn_deg = Vector3d(pitch, roll, yaw) * 180 / std::numbers::pi};
}

Pose pose_at(const Placement& placement, const Vector3d& center, const Eigen::Matrix3d& axes) {
  const Vector3d a = placement.turn_deg * std::numbers::pi / 180;
  const Eigen::Quaterniond R = Eigen::AngleAxisd(a.z(), axes.col(2)) *
                               Eigen::AngleAxisd(a.y(), axes.col(1)) *
                               Eigen::AngleAxisd(a.x(), axes.col(0));
  return {R, center + axes * placement.shift_mm - R * center};
}

Pose snapped(const Pose& pose, const MovableBody& body) {
  constexpr double step_mm = 0.5, step_deg = 1;
  Placement placement = placement_of(pose, body.center, body.axes);
  placement.shift_mm = step_mm * (placement.shift_mm / step_mm).array().round();
  placement.turn_deg = step_deg * (placement.turn_deg / step_deg).array().round();
  return pose_at(placement, body.center, body.axes);
}

}  // namespace condyle
