#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "render/colour_map.h"
#include "render/image.h"
#include "sim/frame/part.h"

namespace condyle {

/// A place where two parts meet or nearly do, and what is to be said of it.
struct ContactPlace {
  std::span<const Part> parts;  // at rest; all of them are drawn in the overview
  std::string fixed, moved;     // names of the two; not the same
  std::span<const float> fixed_values, moved_values;  // one per vertex
  Pose X_CM;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();    // ringed; cranium's frame, mm
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();   // of the close views
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from the fixed to the moved one
  double seen_mm = 45;                                // height of the close views
  std::string overview = "front";                     // standard camera
  std::string title;
  std::vector<std::string> lines;  // under the pictures
  std::vector<Pose> X_CF = {};     // of each free part, in the parts' order
};

/// One picture, 1600 pixels wide: where it is, the fixed part seen from the moved one, the moved
/// part seen from the fixed one (as one opens a book), and the legend of the colours. Needs a
/// current OpenGL context. Without a font of the system it has no words.
Image contact_picture(const ContactPlace& place, const ColourMap& map);

}  // namespace condyle
