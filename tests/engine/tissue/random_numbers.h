#pragma once

#include <cstddef>
#include <random>
#include <vector>

namespace condyle {

/// From -1 to 1; the same each time.
inline std::vector<float> random_numbers(std::size_t size) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> entry(-1, 1);
  std::vector<float> numbers(size);
  for (auto& v : numbers) v = entry(random);
  return numbers;
}

}  // namespace condyle
