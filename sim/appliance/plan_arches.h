#pragma once

#include <string>

#include "sim/appliance/splint.h"
#include "sim/operation/operation.h"

namespace condyle {

/// Which position of the arches a splint holds.
enum class SplintKind {
  intermediate,  // after the move of one jaw, before that of the other
  final_bite     // after both
};
/// The jaw that is moved first.
enum class FirstJaw { upper, lower };

/// Whether a plan moves the body that carries an arch.
bool moves_arch(const Operated& operated, bool upper);

/// Both arches of an operated patient as the splint holds them, closed where they are open.
/// throws: InputError for problems of the plan, an intermediate splint of a plan that moves one jaw
/// alone, a missing arch, and teeth that cannot be closed.
SplintArches splint_arches(const Operated& operated, SplintKind kind,
                           FirstJaw first = FirstJaw::upper);

/// The operated patient at that stage: bones of the jaw that has not been moved lie at rest.
Case patient_at_stage(const Operated& operated, SplintKind kind, FirstJaw first);

}  // namespace condyle
