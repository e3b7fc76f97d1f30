#pragma once

#include "sim/case/case.h"

namespace condyle {

/// Moves parts of roaming bodies (segments, transplants) that start deep (half a millimetre) inside
/// another bone or piece out of it, by a short translation, with an entry in the case's notes. They
/// are processed in order, each out of the fixed bones, the mandible and the pieces before it, the
/// deepest first.
void push_out_pieces(Case& patient);

}  // namespace condyle
