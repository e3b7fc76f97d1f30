#include "sim/scanner/scanned_head.h"

#include <algorithm>

#include "sim/phantom/head_warp.h"
#include "sim/phantom/phantom.h"
#include "sim/phantom/shifted_bite.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The field divided by the length of its gradient: the distance, near the surface.
template <class Field>
double normalized(const Field& field, const Vector3d& p) {
  constexpr double step = 0.02;  // mm
  Vector3d gradient;
  for (int a = 0; a < 3; ++a) {
    const Vector3d by = step * Vector3d::Unit(a);
    gradient[a] = (field(p + by) - field(p - by)) / (2 * step);
  }
  return field(p) / std::max(gradient.norm(), 0.5);
}

}  // namespace

ScannedHead::ScannedHead(const HeadChoice& choice, double tooth_growth_mm)
    : solid_(make_phantom_solid()), tooth_growth_mm_(tooth_growth_mm) {
  if (choice.is_default()) return;
  const HeadShape shape = head_shape(choice);
  const Pose bite =
      shape.bite_forward == 0 ? Pose{} : shifted_bite(builtin_patient(), shape.bite_forward);
  warp_ = std::make_unique<HeadWarp>(shape, bite);
}

ScannedHead::~ScannedHead() = default;
ScannedHead::ScannedHead(ScannedHead&&) noexcept = default;
ScannedHead& ScannedHead::operator=(ScannedHead&&) noexcept = default;

Vector3d ScannedHead::place(HeadMap map, const Vector3d& p) const {
  const Vector3d q = map == HeadMap::skin ? uneven_face(p) : p;
  if (!warp_) return q;
  return map == HeadMap::skull      ? warp_->skull(q)
         : map == HeadMap::mandible ? warp_->mandible(q)
                                    : warp_->skin(q);
}

Vector3d ScannedHead::standard_place(HeadMap map, const Vector3d& p) const {
  if (!warp_ && map != HeadMap::skin) return p;
  // The displacement changes slowly from place to place: each round reduces the error several
  // times.
  constexpr int rounds = 8;
  Vector3d q = p;
  for (int i = 0; i < rounds; ++i) q += p - place(map, q);
  return q;
}

double ScannedHead::upper_bone(const Vector3d& p) const {
  return normalized(
      [&](const Vector3d& at) {
        const Vector3d q = standard_place(HeadMap::skull, at);
        return std::min(solid_.skull(q), solid_.upper_teeth(q) - tooth_growth_mm_);
      },
      p);
}

double ScannedHead::lower_bone(const Vector3d& p) const {
  return normalized(
      [&](const Vector3d& at) {
        const Vector3d q = standard_place(HeadMap::mandible, at);
        return std::min(solid_.mandible(q), solid_.lower_teeth(q) - tooth_growth_mm_);
      },
      p);
}

double ScannedHead::skin(const Vector3d& p) const {
  return normalized(
      [&](const Vector3d& at) { return solid_.skin(standard_place(HeadMap::skin, at)); }, p);
}

}  // namespace condyle
