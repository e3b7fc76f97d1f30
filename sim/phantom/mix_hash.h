#pragma once

#include "engine/core/hash.h"

namespace condyle {

/// Chains the bits of a plain value to a hash.
template <class T>
void mix(std::uint64_t& hash, const T& value) {
  hash = hash_values(std::span<const T>(&value, 1), hash);
}

}  // namespace condyle
