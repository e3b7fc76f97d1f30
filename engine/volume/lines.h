#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "engine/core/parallel.h"

namespace condyle {

/// Number of values of a lattice.
inline std::size_t lattice_count(const std::array<int, 3>& size) {
  return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
         static_cast<std::size_t>(size[2]);
}

/// Calls change(line, n) for every line of a lattice along an axis, with the line's n values as
/// float in contiguous memory, and stores them again with store(float). The first axis is fastest.
/// Lines are changed on several threads; the result is bit-identical for any number.
template <class Value, class Change, class Store>
void change_lines(std::vector<Value>& values, const std::array<int, 3>& size, int axis, int threads,
                  const Change& change, const Store& store) {
  constexpr std::size_t tile = 16;  // lines that are gathered at a time, along the fastest axis
  const auto n = static_cast<std::size_t>(size[static_cast<std::size_t>(axis)]);
  const std::size_t row = static_cast<std::size_t>(size[0]),
                    slice = row * static_cast<std::size_t>(size[1]);
  const std::size_t step = axis == 0 ? 1 : axis == 1 ? row : slice;
  const std::size_t fast = axis == 0 ? static_cast<std::size_t>(size[1]) : row;
  const std::size_t slow = static_cast<std::size_t>(axis == 2 ? size[1] : size[2]);
  const std::size_t fast_step = axis == 0 ? row : 1, slow_step = axis == 2 ? row : slice;
  parallel_for(slow, threads, [&](std::size_t s) {
    std::vector<float> lines(tile * n);
    for (std::size_t first = 0; first < fast; first += tile) {
      const std::size_t count = std::min(tile, fast - first);
      Value* start = values.data() + s * slow_step + first * fast_step;
      for (std::size_t q = 0; q < n; ++q)
        for (std::size_t l = 0; l < count; ++l)
          lines[l * n + q] = static_cast<float>(start[q * step + l * fast_step]);
      for (std::size_t l = 0; l < count; ++l) change(lines.data() + l * n, n);
      for (std::size_t q = 0; q < n; ++q)
        for (std::size_t l = 0; l < count; ++l)
          start[q * step + l * fast_step] = store(lines[l * n + q]);
    }
  });
}

}  // namespace condyle
