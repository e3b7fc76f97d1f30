#pragma once

#include <vector>

#include "sim/case/case.h"

namespace condyle {

/// Muscles of an average adult fitted to a patient's landmarks: attachments scaled by the distance
/// between the condyles and from these to the lower incisal point, the hyoid at its landmark (else
/// below the jaw); published strengths at 40 N/cm^2, lengths at rest taken as optimal. Names as in
/// tables of measured patients ("lat", "rsm").
/// throws: InputError when a condyle or the lower incisal point is missing.
/// source: strengths Peck 2000, Hannam 2008; tendon ratios after van Eijden 1997.
std::vector<Muscle> default_muscles(const Case& patient);

/// The muscles of the case, else the default ones.
std::vector<Muscle> muscles_of(const Case& patient);

/// Centre of the hyoid: mean of the muscle attachments on it; absent without any.
std::optional<Eigen::Vector3d> hyoid_center(const std::vector<Muscle>& muscles);

}  // namespace condyle
