#pragma once

#include <optional>
#include <vector>

#include "engine/collide/slide.h"
#include "engine/math/pose.h"
#include "engine/mesh/measure.h"

namespace condyle {

/// What the field of a surface does not tell.
struct FieldSight {
  Box box;                   // of the whole surface, its own coordinates
  std::vector<Box> outside;  // what of it lies outside the field's region
  bool blind = false;        // all of it does
  bool thin = false;         // walls thinner than the field's spacing
};

FieldSight field_sight(const Box& surface, const std::optional<Box>& region);

/// Whether more than a tenth of a surface, but for its edges, is so thin that its field hardly
/// tells its inside.
bool is_thin(const SlideBody& body);

/// Whether two boxes, each along the axes of its own coordinates, come nearer than `within_mm`;
/// sometimes said of boxes that are a little farther apart.
bool boxes_meet(const Box& a, const Box& b, const Pose& X_AB, double within_mm);

}  // namespace condyle
