#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/case/muscle.h"

namespace condyle {

/// Indices of the muscles that a name refers to: one ("lat"), a kind on both sides ("at"), or a
/// group: t temporalis, m masseter, my mylohyoid, lp lateral pterygoid, close, open, hopen, pro,
/// protracthyoid, retracthyoid, suprahyoid, infrahyoid, stiffenjaw, with l or r before it for one
/// side (bi_ before any name: both). Empty: the name is unknown.
std::vector<std::size_t> muscles_named(std::string_view name, std::span<const Muscle> muscles);

/// Abbreviated full name, with the patient's side first: "L Ant. Temporal" for the left "Anterior
/// Temporal". Without a side: the name alone.
std::string short_name(const Muscle& muscle);

/// All valid names, for a message.
std::string list_muscle_names(std::span<const Muscle> muscles);

}  // namespace condyle
