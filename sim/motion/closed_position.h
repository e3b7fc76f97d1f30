#pragma once

#include "sim/case/case.h"

namespace condyle {

/// Sets the closed position (Case::X_CM_closed) of a patient scanned with the mouth open: a
/// rotation about the condyles by the declared opening of the scan, else until the teeth meet. It
/// is the rest pose where the teeth are at most 1.5 mm apart at rest, or where teeth or landmarks
/// are missing. throws: InputError when the declared opening is not reached.
void locate_closed_position(Case& patient);

/// The same for a patient that was just imported, with a note in `patient.notes` where it was
/// scanned with the mouth open.
void report_scan_opening(Case& patient);

}  // namespace condyle
