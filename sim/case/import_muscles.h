#pragma once

#include "engine/mesh/measure.h"
#include "sim/case/case_io.h"

namespace condyle {

/// Reads the muscles and the mechanics that the request names into the case. `box` is that of the
/// surfaces. throws: InputError, also for muscles far from the patient.
void import_muscles(const ImportRequest& request, const Box& box, Case& patient);

}  // namespace condyle
