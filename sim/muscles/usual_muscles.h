#pragma once

#include <vector>

#include "sim/case/case.h"

namespace condyle {

/// Muscles of an average adult put to a patient's landmarks: attachments by the distance between
/// the condyles and from them to the lower incisal point, the hyoid where its landmark is (else
/// below the jaw); strengths of 40 N/cm^2 as published, lengths at rest taken as optimal. Names as
/// in tables of measured patients ("lat", "rsm").
/// throws: InputError when a condyle or the lower incisal point is missing.
/// source: strengths Peck 2000, Hannam 2008; tendon shares after van Eijden 1997.
std::vector<Muscle> usual_muscles(const Case& patient);

/// The patient's own, else the usual ones.
std::vector<Muscle> muscles_of(const Case& patient);

/// Middle of the hyoid: mean of the muscles' attachments on it; absent when none is there.
std::optional<Eigen::Vector3d> hyoid_center(const std::vector<Muscle>& muscles);

}  // namespace condyle
