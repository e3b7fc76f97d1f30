#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "render/image/colour_map.h"
#include "render/image/image.h"
#include "sim/frame/body_poses.h"
#include "sim/frame/part.h"

namespace condyle {

/// A contact or near contact of two parts, with its caption.
struct ContactView {
  std::span<const Part> parts;  // at rest; all of them are drawn in the overview
  std::string fixed, moved;     // names of the two; different
  std::span<const float> fixed_values, moved_values;  // one per vertex
  BodyPoses at;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();    // marked; cranium's frame, mm
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();   // centre of the close views
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from the fixed to the moved one
  double seen_mm = 45;                                // height of the close views
  std::string overview = "front";                     // standard camera
  std::string title;
  std::vector<std::string> lines;  // under the pictures
};

/// One picture, 1600 pixels wide: an overview, the fixed part viewed from the moved one, the moved
/// part viewed from the fixed one (as an open book), and the legend of the colours. Needs a current
/// OpenGL context. Without a system font it has no text.
Image contact_picture(const ContactView& place, const ColourMap& map);

}  // namespace condyle
