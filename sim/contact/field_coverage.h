#pragma once

#include <optional>
#include <vector>

#include "engine/collide/slide.h"
#include "engine/math/pose.h"
#include "engine/mesh/measure.h"

namespace condyle {

/// Parts of a surface that its field does not cover.
struct FieldCoverage {
  Box box;                   // of the whole surface, its own coordinates
  std::vector<Box> outside;  // boxes of it outside the field's region
  bool uncovered = false;    // all of it is outside
  bool thin = false;         // walls thinner than the field's spacing
};

FieldCoverage field_coverage(const Box& surface, const std::optional<Box>& region);

/// Whether more than a tenth of a surface, except its edges, is so thin that its field hardly has
/// an inside.
bool is_thin(const ContactSurface& body);

/// Whether two boxes, each along the axes of its own coordinates, are nearer than `within_mm`; may
/// be true for boxes slightly farther apart.
bool boxes_meet(const Box& a, const Box& b, const Pose& X_AB, double within_mm);

}  // namespace condyle
