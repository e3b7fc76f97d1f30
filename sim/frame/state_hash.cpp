#include "sim/frame/state_hash.h"

#include <array>
#include <bit>
#include <cstring>
#include <type_traits>

#include "engine/core/hash.h"
#include "sim/frame/frame_fields.h"

namespace condyle {
namespace {

class Hasher {
 public:
  template <class T>
  void operator()(const T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      add(&value, sizeof value);
    else
      add(value.data(), sizeof(typename T::Scalar) * static_cast<std::size_t>(value.size()));
  }
  template <class List>
  void size_of(const List& list) {
    (*this)(list.size());
  }
  /// A list of vectors without padding.
  template <class Vector>
  void values(const std::vector<Vector>& list) {
    static_assert(sizeof(Vector) == 3 * sizeof(typename Vector::Scalar));
    size_of(list);
    add(list.data(), list.size() * sizeof(Vector));
  }
  std::uint64_t value() const { return hash_; }

 private:
  /// Eight bytes at a time, in four independent chains: a face has several hundred thousand bytes.
  void add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    if (size >= 32) {
      std::array<std::uint64_t, 4> chains = {hash_, hash_ + 1, hash_ + 2, hash_ + 3};
      for (; size >= 32; bytes += 32, size -= 32)
        for (std::size_t k = 0; k < 4; ++k) chains[k] = mixed(chains[k], word_at(bytes + 8 * k));
      for (const std::uint64_t chain : chains) hash_ = mixed(hash_, chain);
    }
    for (; size >= 8; bytes += 8, size -= 8) hash_ = mixed(hash_, word_at(bytes));
    if (size == 0) return;  // an empty list has no address
    std::uint64_t rest = 0;
    std::memcpy(&rest, bytes, size);
    hash_ = mixed(hash_, rest);
  }
  static std::uint64_t word_at(const unsigned char* bytes) {
    std::uint64_t word;
    std::memcpy(&word, bytes, 8);
    return word;
  }
  static std::uint64_t mixed(std::uint64_t hash, std::uint64_t word) {
    return std::rotl(hash ^ word, 29) * 0x9E3779B97F4A7C15ull;
  }

  std::uint64_t hash_ = hash_start;
};

}  // namespace

std::uint64_t state_hash(const FrameState& frame) {
  Hasher hasher;
  visit_frame(frame, hasher);
  return hasher.value();
}

}  // namespace condyle
