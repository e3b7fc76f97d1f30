#pragma once

#include <filesystem>

#include "engine/core/progress.h"
#include "sim/case/case.h"

namespace condyle {

/// The built-in patient, made by code: an adult head of distance fields. Deterministic; about 6 s
/// on two cores.
Case build_phantom(const Progress& progress = {});

/// The same, kept in the user's cache folder ($XDG_CACHE_HOME/condyle, else ~/.cache/condyle) and
/// made again when the cache is absent, damaged or of another version. A cache that cannot be
/// written is no error.
Case builtin_patient(const Progress& progress = {});

}  // namespace condyle
