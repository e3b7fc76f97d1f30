#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "sim/case/muscle.h"
#include "sim/muscles/excitation_curve.h"

namespace condyle {

/// Excitation of each muscle over time.
struct Excitations {
  struct Channel {
    ExcitationCurve curve;
    std::vector<std::size_t> muscles;  // muscles it excites
  };

  double duration_s = 0;
  std::vector<Channel> channels;
  std::vector<double> tone;          // constant excitation of each muscle, added to the channels
  std::vector<std::string> without;  // muscles removed from the model

  /// One value from 0 to 1 for each remaining muscle; constant beyond the ends.
  std::vector<double> at(double time_s) const;
};

/// Reads a CSV in one of two layouts. Wide: a column time_s and one column for each muscle, kind or
/// group (sim/muscles/muscle_names.h); time is counted from the first row. Long: one row per knot
/// with the columns muscle, time_s, excitation and optionally interpolation and active (rows with 0
/// there are ignored); time is taken as written. Values are 0 to 1 (knots of a cubic may be
/// slightly negative and are clamped); several columns that excite the same muscle add up, to 1 at
/// most. The default interpolation is "smooth"; step, linear and cubic are the others (see
/// Interpolation). Lines that start with # are ignored, except for "# interpolation: step".
///
/// The sidecar FILE.json, all keys optional: {"interpolation": "cubic", "tone": {"close": 0.001},
/// "without": ["pm"], "until_s": 1}. The tone is added to the excitation of these muscles; muscles
/// in `without` are removed and their data ignored; the motion ends at `until_s` instead of at the
/// last time. throws: InputError with file, line and value.
Excitations read_excitations(const std::filesystem::path& file, std::span<const Muscle> muscles);

}  // namespace condyle
