#include "sim/phantom/head_warp.h"

#include <cmath>

#include "engine/field/primitives.h"
#include "engine/field/smooth.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

Pose shifted(const Vector3d& by) { return {Eigen::Quaterniond::Identity(), by}; }

/// The joint with the condyle's whole path, the coronoid process and the ear canal.
const Vector3d joint_center(50, -20, -6), joint_half(16, 25, 17);
constexpr double joint_rounding = 8;

}  // namespace

HeadWarp::HeadWarp(const HeadShape& shape, const Pose& bite) : shape_(shape) {
  const Vector3d arch(0, -68, -52);
  Pose upper;
  upper.R = axis_rotation('y', shape.cant_deg);
  upper.t = arch - upper.R * arch + Vector3d(0, -shape.maxilla_forward, -shape.upper_height);
  const Pose lower = upper * bite;

  const auto both = [&](std::vector<Region>& list, const Region& left) {
    list.push_back(left);
    Region right = left;
    right.center.x() = -right.center.x();
    right.motion.t.x() = -right.motion.t.x();
    list.push_back(right);
  };
  const Pose outward = shifted({shape.face_width / 2, 0, 0});
  for (auto* list : {&skull_, &mandible_}) {
    both(*list, {joint_center, joint_half, joint_rounding, outward});
    list->push_back({{0, 25, -150}, {70, 45, 55}, 20, {}});   // neck
    list->push_back({{0, 60, 20}, {90, 60, 110}, 30, {}});    // back of the head
    list->push_back({{0, -35, -165}, {40, 25, 35}, 10, {}});  // throat
  }
  skull_.push_back({{0, -67, -47}, {33, 33, 16}, 15, upper});
  both(skull_, {{31, -72, 17}, {18, 17, 15}, 6, shifted({shape.face_width / 8, 0, 0})});
  both(skull_, {{60, -42, -8}, {6, 14, 6}, 4, outward});  // arch of the cheek bone
  skull_.push_back({{0, -80, 34}, {10, 16, 14}, 6, {}});  // nasion and glabella
  skull_.push_back({{0, 0, 90}, {90, 110, 40}, 30, {}});  // vault
  skull_.push_back({{0, -20, 0}, {18, 25, 15}, 8, {}});   // base

  mandible_.push_back({{0, -66, -63}, {31, 32, 17}, 15, lower});
  mandible_.push_back(
      {{0, -84, -88}, {16, 7, 6}, 4, shifted({0, -shape.chin_forward, -shape.chin_down}) * lower});
  both(mandible_, {{47, -18, -63},
                   {5, 5, 5},
                   4,
                   shifted({shape.gonial_width / 2, -shape.gonion_forward, -shape.gonion_down})});
}

double HeadWarp::distance(const Region& region, const Vector3d& p) {
  const Vector3d q =
      (p - region.center).cwiseAbs() - region.half + Vector3d::Constant(region.rounding);
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0) - region.rounding;
}

double HeadWarp::joint_distance(const Vector3d& p) {
  return distance({joint_center, joint_half, joint_rounding, {}}, {std::abs(p.x()), p.y(), p.z()});
}

Vector3d HeadWarp::blended(const std::vector<Region>& regions, const Vector3d& p) {
  Vector3d sum = Vector3d::Zero();
  double weights = 0;
  for (const auto& region : regions) {
    const double d = distance(region, p);
    if (d <= 1e-6) return region.motion * p;
    sum += (region.motion * p - p) / (d * d);
    weights += 1 / (d * d);
  }
  return p + sum / weights;
}

/// Without a cant the map is its own exact mirror image.
Vector3d HeadWarp::mirrored(const Vector3d& p, Map map) const {
  if (shape_.cant_deg != 0) return (this->*map)(p);
  Vector3d q = (this->*map)({std::abs(p.x()), p.y(), p.z()});
  if (p.x() < 0) q.x() = -q.x();
  if (p.x() == 0) q.x() = 0;
  return q;
}

Vector3d HeadWarp::skull(const Vector3d& p) const { return mirrored(p, &HeadWarp::warp_skull); }
Vector3d HeadWarp::mandible(const Vector3d& p) const {
  return mirrored(p, &HeadWarp::warp_mandible);
}
Vector3d HeadWarp::skin(const Vector3d& p) const { return mirrored(p, &HeadWarp::warp_skin); }

Vector3d HeadWarp::warp_skull(const Vector3d& p) const { return blended(skull_, p) + vault(p); }

Vector3d HeadWarp::warp_mandible(const Vector3d& p) const { return blended(mandible_, p); }

Vector3d HeadWarp::warp_skin(const Vector3d& p) const {
  // The lower lip goes with the mandible, the upper one mostly with the maxilla.
  // Beside the mouth the cheek stretches over more height.
  const double wider = 18 * smooth_step((std::abs(p.x()) - 22) / 20);
  const double below = smooth_step((-40 + wider - p.z()) / (16 + 2 * wider));
  return (1 - below) * blended(skull_, p) + below * blended(mandible_, p) + vault(p) + nose(p);
}

/// Displacement of the brain case and the scalp; none at face and joints.
Vector3d HeadWarp::vault(const Vector3d& p) const {
  constexpr double half_width = 70;  // mm, of the bone
  const double x = p.x(), y = p.y(), z = p.z();
  const double above = smooth_step((z - 4) / 42);
  const double wide = shape_.vault_width / 2 / half_width;
  Vector3d by(x * wide * above * smooth_step((y + 78) / 55), 0, 0);
  by.y() = shape_.vault_length * smooth_step((y - 4) / 92) * smooth_step((z + 38) / 40) -
           shape_.forehead_forward * smooth_step((-y - 30) / 50) * smooth_step((z - 42) / 34);
  by.z() = shape_.vault_height * smooth_step((z - 25) / 85) +
           shape_.sagittal_ridge * std::exp(-x * x / 81) * smooth_step((y + 50) / 35) *
               smooth_step((100 - y) / 40) * smooth_step((z - 60) / 40);
  return by;
}

Vector3d HeadWarp::nose(const Vector3d& p) const {
  const Vector3d q = (p - Vector3d(0, -112, -17)).cwiseQuotient(Vector3d(24, 22, 20));
  const double near = std::exp(-q.squaredNorm());
  return {p.x() * shape_.nose_width / 36 * near, -shape_.nose_forward * near, 0};
}

}  // namespace condyle
