#pragma once

#include "sim/case/case.h"
#include "sim/case/case_io.h"

namespace condyle {

/// Refuses upper and lower jaws, teeth or incisal points that are exchanged, by their heights where
/// one lies above the other; the message states the right options. Adds a note where the teeth are
/// inconclusive. `patient`: as converted by the request, in a frame that has
/// been checked. throws: InputError.
void check_jaw_order(Case& patient, const ImportRequest& request);

}  // namespace condyle
