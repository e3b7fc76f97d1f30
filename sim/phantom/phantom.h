#pragma once

#include <filesystem>

#include "engine/core/progress.h"
#include "sim/case/case.h"
#include "sim/phantom/head_shape.h"

namespace condyle {

/// Case::name of the standard head; others have the name that head_name() gives.
inline constexpr const char* builtin_case_name = "built-in patient";

/// The built-in patient, generated from distance fields: an adult head. Deterministic; about 6 s on
/// two cores.
Case build_phantom(const Progress& progress = {});

/// The same from the user's cache folder ($XDG_CACHE_HOME/condyle, else ~/.cache/condyle);
/// generated again when the cache is absent, damaged or of another version. A cache that cannot be
/// written is not an error.
Case builtin_patient(const Progress& progress = {});

/// The built-in patient, `patient`, with the shape of a chosen head; itself for the default choice.
/// Topology, colours, joints and the shapes of teeth are kept. About 1 s.
Case reshaped_head(Case patient, const HeadChoice& choice);

/// The chosen head, from the cached built-in patient.
Case builtin_patient(const HeadChoice& choice, const Progress& progress = {});

}  // namespace condyle
