#pragma once

#include "sim/case/case.h"

namespace condyle {

// Edits of a patient's bodies: each returns a new case, so that earlier cases form an undo history.
// edited_scene() rebuilds the simulation models.

/// Appends a part with its own body. throws: InputError for a duplicate part or body name, or an
/// unknown parent.
Case with_piece(Case patient, Part part, BodyId parent, BodyDriver driver = BodyDriver::hand);

/// Gives a body another parent; bodies may be renumbered. throws: InputError as
/// BodyTree::reparent().
Case with_parent(Case patient, BodyId body, BodyId parent);

/// Removes a body with its parts, their contact rules and its canals; its children become children
/// of its parent. throws: InputError for the cranium and for bodies of the jaw.
Case without_body(Case patient, BodyId body);

}  // namespace condyle
