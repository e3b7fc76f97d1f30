#include "sim/scanner/scanner_noise.h"

namespace condyle {
namespace {

std::uint64_t scrambled(std::uint64_t x) {  // source: splitmix64, Steele et al. 2014
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

}  // namespace

double uniform_number(std::uint64_t seed, std::uint64_t place) {
  return static_cast<double>(scrambled(scrambled(seed) + place) >> 11) * 0x1p-53;
}

/// The sum of twelve uniform numbers of 16 bits, without any function whose last bit depends on the
/// machine.
double normal_number(std::uint64_t seed, std::uint64_t place) {
  const std::uint64_t start = scrambled(seed);
  std::uint64_t sum = 0;
  for (std::uint64_t part = 0; part < 3; ++part) {
    const std::uint64_t bits = scrambled(start + 3 * place + part);
    for (int shift = 0; shift < 64; shift += 16) sum += bits >> shift & 0xffff;
  }
  return (static_cast<double>(sum) + 6) * 0x1p-16 - 6;
}

}  // namespace condyle
