#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "sim/case/muscle.h"
#include "sim/muscles/excitation_curve.h"

namespace condyle {

/// How much each muscle is excited over time.
struct Excitations {
  struct Channel {
    ExcitationCurve curve;
    std::vector<std::size_t> muscles;  // that it excites
  };

  double duration_s = 0;
  std::vector<Channel> channels;
  std::vector<double> tone;          // of each muscle, beside what the channels say
  std::vector<std::string> without;  // muscles that were taken out of those given

  /// One value of 0 to 1 for each muscle that is not taken out; constant beyond the ends.
  std::vector<double> at(double time_s) const;
};

/// A CSV in one of two shapes. Wide: the column time_s and a column for each muscle, kind or group
/// (sim/muscles/muscle_names.h); time is counted from the first row. Long: a row for each knot with
/// the columns muscle, time_s, excitation and, if wanted, interpolation and active (rows with 0
/// there are passed over); time as it stands. All from 0 to 1 (knots of a cubic may dip a little
/// below, which is cut off); what several columns say of a muscle adds up, to 1 at most. Between
/// its rows a value goes "smooth" (cubic without overshoot), unless told: step, linear or cubic
/// (see Between). Lines that start with # are passed over, but for "# interpolation: step".
///
/// FILE.json beside it, all keys optional: {"interpolation": "cubic", "tone": {"close": 0.001},
/// "without": ["pm"], "until_s": 1}. The tone is added to what the file says of these muscles;
/// those in `without` are taken out, and what the file says of them is passed over; the motion ends
/// at `until_s` in place of the last time. throws: InputError with file, line and value.
Excitations read_excitations(const std::filesystem::path& file, std::span<const Muscle> muscles);

}  // namespace condyle
