#pragma once

#include "sim/anatomy_fit/part_landmarks.h"

namespace condyle {

/// Moves the landmarks that have a definition of their own on the surface, such as menton, the
/// lowest point of the chin, to where the scan fulfils it, within 6 mm. Points inside bone stay.
void apply_definitions(std::map<std::string, ProposedLandmark>& marks, const FittedPart& part,
                       const Case& model);

}  // namespace condyle
