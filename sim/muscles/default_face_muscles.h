#pragma once

#include <string>
#include <vector>

#include "sim/case/case.h"
#include "sim/case/face_muscle.h"

namespace condyle {

/// The landmark that the muscles of the face need and a patient lacks; empty: none.
std::string missing_face_landmark(const Case& patient);

/// Muscles of facial expression of an average adult, placed by a patient's landmarks; none if one
/// is missing. source: origins, insertions and widths from anatomical studies; the tension limits
/// are chosen so that a smile has the published displacement.
std::vector<FaceMuscle> default_face_muscles(const Case& patient);

}  // namespace condyle
