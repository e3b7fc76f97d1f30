#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace condyle {

/// FNV-1a over bytes, 64 bit; chain by passing the previous value.
constexpr std::uint64_t hash_start = 14695981039346656037ull;

inline std::uint64_t hash_bytes(const void* data, std::size_t size, std::uint64_t h = hash_start) {
  const auto* p = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i) h = (h ^ p[i]) * 1099511628211ull;
  return h;
}

/// Hash of the bits of plain values; -0.0 and 0.0 differ, as a bit-for-bit replay demands.
template <class T>
std::uint64_t hash_values(std::span<const T> values, std::uint64_t h = hash_start) {
  static_assert(std::is_trivially_copyable_v<T>);
  return hash_bytes(values.data(), values.size_bytes(), h);
}

}  // namespace condyle
