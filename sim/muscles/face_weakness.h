#pragma once

#include <span>
#include <string>
#include <vector>

#include "sim/case/face_muscle.h"
#include "sim/frame/face_excitation.h"

namespace condyle {

/// Checks SIDE:STRENGTH or MUSCLE:STRENGTH as far as possible without a patient.
/// throws: InputError.
void check_weakness(std::span<const std::string> specs);

/// 1 healthy to 0 paralysed, as in facial palsy.
struct FaceStrengths {
  std::vector<double> muscles;  // of each muscle
  LidStrength lids = {};
};

/// Strengths by those of a side (left, right), a muscle, or a kind on both sides. Several for one
/// muscle multiply; muscles in the middle have the mean of both sides.
/// throws: InputError for unknown names and values outside 0 to 1.
FaceStrengths muscle_strengths(std::span<const std::string> specs,
                               std::span<const FaceMuscle> muscles);

/// What weak muscles make of an excitation; weak lids close less, as in lagophthalmos.
FaceExcitation weakened(FaceExcitation healthy, const FaceStrengths& strengths);

}  // namespace condyle
