#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "engine/volume/volume.h"
#include "sim/scanner/scanned_head.h"

// What a scan holds beside the patient. Bit-identical for any number of threads. Only for this
// module.
namespace condyle {

// Hounsfield units in 12 bits, as scanners store them.
constexpr int least_stored_hu = -1024, most_stored_hu = 3071;

inline std::int16_t stored_hu(double hu) {
  return static_cast<std::int16_t>(
      std::lround(std::clamp<double>(hu, least_stored_hu, most_stored_hu)));
}

/// A head rest of 3 mm plastic behind the head on a foam of 1 mm, and a table of thin plates filled
/// with foam, which has two metal rails.
void draw_table(const ScannedHead& head, int threads, Volume& volume);

/// Fillings of metal in two lower molars and an upper one, with streaks in their slices.
void draw_fillings(const ScannedHead& head, std::uint64_t seed, int threads, Volume& volume);

}  // namespace condyle
