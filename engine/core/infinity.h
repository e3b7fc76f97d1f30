#pragma once

#include <limits>

namespace condyle {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

}  // namespace condyle
