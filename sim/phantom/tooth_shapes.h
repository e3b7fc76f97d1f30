#pragma once

#include <string>
#include <vector>

#include "engine/field/primitives.h"

namespace condyle {

/// Position and size of one tooth of the left side. mm.
struct ToothFrame {
  bool upper = true;
  std::string name;                // I1 I2 C P1 P2 M1 M2
  int fdi = 0;                     // left side
  double width = 0, depth = 0;     // mesio-distal, labio-lingual
  double height = 0, root = 0;     // crown, root
  Eigen::Vector3d tip;             // on the incisal edge or over the central fossa
  Eigen::Vector3d axis;            // towards the tip
  Eigen::Vector3d distal, labial;  // unit, at right angles to the axis
  Eigen::Vector3d neck() const { return tip - height * axis; }
};

/// The 7 upper and 7 lower teeth of the left side, from the midline back.
const std::vector<ToothFrame>& tooth_frames();
std::vector<ToothFrame> tooth_frames(bool upper);

/// Crown and root of one tooth, not yet carved by its opponents.
Primitive tooth_shape(const ToothFrame& frame);

/// Uncarved tip: middle of the incisal edge, cusp of a canine, buccal cusp of a premolar,
/// mesiobuccal cusp of a molar.
Eigen::Vector3d tooth_tip(const ToothFrame& frame);

/// End of the root, on its surface. Molars have one root too.
Eigen::Vector3d tooth_apex(const ToothFrame& frame);

/// The same outline grown over neck and root: what the gum wraps around the tooth.
Primitive tooth_collar(const ToothFrame& frame, double thickness);

}  // namespace condyle
