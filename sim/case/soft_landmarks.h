#pragma once

#include "sim/case/case.h"

namespace condyle {

/// Fills midline landmarks that the case lacks from its surfaces: pogonion (bone), pronasale,
/// subnasale, stomion, labrale_superius, labrale_inferius and soft_pogonion, and the corners of a
/// mouth that is an opening of the surface, with an entry in the notes. Needs the incisal points;
/// omits landmarks that the surfaces do not show.
void estimate_profile_landmarks(Case& patient);

}  // namespace condyle
