#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "sim/case/case.h"

namespace condyle {

/// The case kept under a name in a cache folder; made and put there when it is absent or damaged
/// (its content is sealed by a hash beside it). A cache that cannot be written is no error; what
/// `make` throws goes through.
Case kept_case(const std::filesystem::path& cache, const std::string& name,
               const std::function<Case()>& make);

}  // namespace condyle
