#pragma once

#include "sim/prediction/prediction.h"

namespace condyle {

/// The patient's landmarks after the operation: those of bones and teeth with their segments, those
/// of the skin as predicted.
Landmarks predicted_landmarks(const Prediction& prediction);

}  // namespace condyle
