#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sim/frame/body_tree.h"

namespace condyle {

/// A canal in a bone, such as the mandibular canal: its centre line at rest, in the cranium's
/// frame, mm.
struct Canal {
  std::string name;  // lower case words joined by '_', e.g. left_mandibular_canal
  BodyId body = mandible_body;
  double diameter_mm = 0;
  std::vector<Eigen::Vector3d> points;  // two or more, from one mouth to the other
};

}  // namespace condyle
