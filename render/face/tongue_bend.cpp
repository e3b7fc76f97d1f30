#include "render/face/tongue_bend.h"

#include <algorithm>

#include "engine/math/smooth_step.h"

namespace condyle {
namespace {

using Eigen::Vector3f;

// Of the box of the tongue: from its tip backward, from its underside downward.
constexpr float hyoid_back = 0.79f, hyoid_down = 0.73f;
constexpr float bends_from = 0.4f, bends_over = 0.55f, root_per_down = 0.7f;
constexpr float flat_mm = 1e-3f;                  // extent of a tongue that has none
constexpr double follows = 0.5, descends = 0.25;  // over its way backward

Eigen::Affine3f affine(const Pose& pose) {
  Eigen::Affine3d all = Eigen::Affine3d::Identity();
  all.rotate(pose.R);
  all.pretranslate(pose.t);
  return all.cast<float>();
}

}  // namespace

TongueBend::TongueBend(const Eigen::AlignedBox3f& tongue, const Pose& X_CM)
    : tongue_(tongue), mandible_(affine(X_CM)) {
  const Vector3f size = tongue.sizes();
  const Vector3f hyoid(tongue.center().x(), tongue.min().y() + hyoid_back * size.y(),
                       tongue.min().z() - hyoid_down * size.z());
  const Eigen::Vector3d at = hyoid.cast<double>();
  Pose X_CH = interpolate({}, X_CM, follows, at);
  X_CH.t.z() -= descends * std::max(0.0, (X_CH * at - at).y());
  hyoid_ = affine(X_CH);
}

Vector3f TongueBend::operator()(const Vector3f& rest) const {
  const Vector3f size = tongue_.sizes().cwiseMax(flat_mm);
  const float back = (rest.y() - tongue_.min().y()) / size.y();
  const float down = std::max(0.f, (tongue_.min().z() - rest.z()) / size.z());
  const auto root =
      static_cast<float>(smooth_step((back + root_per_down * down - bends_from) / bends_over));
  return mandible_ * rest + root * (hyoid_ * rest - mandible_ * rest);
}

}  // namespace condyle
