#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/case/face_muscle.h"

namespace condyle {

/// Checks SIDE:STRENGTH or MUSCLE:STRENGTH as far as possible without a patient.
/// throws: InputError.
void check_weakness(std::span<const std::string> specs);

/// Strength of each muscle, 1 healthy to 0 paralysed, as in facial palsy: of a side (left, right),
/// a muscle, or a kind on both sides. Several for one muscle multiply; muscles in the middle have
/// the mean of both sides. throws: InputError for unknown names and values outside 0 to 1.
std::vector<double> muscle_strengths(std::span<const std::string> specs,
                                     std::span<const FaceMuscle> muscles);

}  // namespace condyle
