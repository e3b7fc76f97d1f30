#pragma once

#include "sim/case/case.h"

namespace condyle {

/// Moves segments and transplants that start deep (half a millimetre) inside another bone or piece
/// out of it, on a short way, and tells so in the case's notes. They are taken in order, each out
/// of the fixed bones, the mandible and the free parts before it, the deepest first.
void push_out_free_parts(Case& patient);

}  // namespace condyle
