#pragma once

#include <cstdint>

namespace condyle {

// Random numbers by their place in a sequence: the same on every machine, in any order.

/// From 0 to 1.
double uniform_number(std::uint64_t seed, std::uint64_t place);

/// Of the normal distribution with standard deviation 1, limited to 6.
double normal_number(std::uint64_t seed, std::uint64_t place);

}  // namespace condyle
