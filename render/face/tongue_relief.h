#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "render/face/mouth_lining.h"

namespace condyle {

/// Places that the papillae and the furrow of a tongue are tied to, mm: distance from its middle,
/// and along its back, which is unrolled about a transverse axis from tip to root; the third is 0.
/// rest: its vertices, LPS.
std::vector<Eigen::Vector3f> unrolled_tongue(std::span<const Eigen::Vector3f> rest);
/// The same of the tongue of a lining: from its middle, and backward.
std::vector<Eigen::Vector3f> unrolled_tongue(const MouthLining& lining);

/// 0 to 1, 1 without papillae: there are none on the sides of a tongue, where that unrolling would
/// draw them out, nor under it. normal: unit, at rest.
float smoothness_of_tongue(const Eigen::Vector3f& normal);

}  // namespace condyle
