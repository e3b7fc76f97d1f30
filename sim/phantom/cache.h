#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "sim/case/case.h"

namespace condyle {

/// The case stored under a name in a cache folder; made and stored when it is absent or damaged
/// (its content is verified by a stored hash). A cache that cannot be written is not an error;
/// exceptions of `make` are passed on.
Case cached_case(const std::filesystem::path& cache, const std::string& name,
                 const std::function<Case()>& make);

}  // namespace condyle
