#pragma once

#include <string>
#include <vector>

#include "sim/case/case.h"
#include "sim/case/face_muscle.h"

namespace condyle {

/// The landmark for want of which a patient has no muscle that moves the mouth; empty: it has some.
std::string missing_face_landmark(const Case& patient);

/// Muscles of facial expression of an average adult, each placed by a patient's landmarks; those
/// whose landmarks are missing are left out. source: origins, insertions and widths from anatomical
/// studies; the tension limits are chosen so that a smile has the published displacement.
std::vector<FaceMuscle> default_face_muscles(const Case& patient);

/// The muscles of the case, with the bodies of its jaw and the strengths of their kinds, and
/// default ones of the kinds that it lacks.
std::vector<FaceMuscle> muscles_of_face(const Case& patient);

}  // namespace condyle
