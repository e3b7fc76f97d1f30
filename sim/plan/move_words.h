#pragma once

#include <optional>
#include <span>
#include <string>

#include "sim/plan/clinical_frame.h"
#include "sim/plan/move.h"

namespace condyle {

/// A move as a person writes it.
struct WrittenMove {
  ClinicalMove move;
  /// A second point that the pitch brings to a height, see with_height().
  struct Height {
    std::string landmark;
    double up_mm = 0;
  };
  std::optional<Height> height;
};

/// Reads words such as `forward 4 up 2 pitch 2.3 about upper_incisal_point`, in any order; commas
/// do not matter. Displacements in mm: left, right, forward (advance), back (setback), up (impact),
/// down (extrude); rotations in degrees: pitch, roll, yaw. `pns up 4` gives the height of a second
/// point in place of a pitch. Landmarks may have any of their names.
/// throws: InputError naming the word.
WrittenMove parse_move_words(std::span<const std::string> words);

/// The move, with the pitch that its height requires. throws: InputError for a landmark that is
/// missing, and as with_height().
ClinicalMove completed_move(const WrittenMove& written, const std::string& segment,
                            const Landmarks& landmarks, const ClinicalFrame& frame);

}  // namespace condyle
