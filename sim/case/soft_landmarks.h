#pragma once

#include "sim/case/case.h"

namespace condyle {

/// Fills midline landmarks that the case lacks from its surfaces: pogonion (bone), pronasale,
/// stomion, labrale_superius, labrale_inferius and soft_pogonion, with an entry in the notes.
/// Needs the incisal points; omits landmarks that the profile does not show.
void estimate_profile_landmarks(Case& patient);

}  // namespace condyle
