#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/case/motion_parameters.h"

namespace condyle {

enum class Verb {
  open,
  close,
  hinge,
  protrude,
  retrude,
  left,
  right,
  rest,
  hold,
  posselt,
  chew_left,
  chew_right
};

/// One movement in words.
struct Statement {
  Verb verb = Verb::open;
  std::optional<double> amount = {};      // mm, deg (hinge), s (hold), cycles (chew)
  std::optional<double> duration_s = {};  // "over 2"
  std::optional<double> speed_mm_s = {};  // "at 60"
  std::optional<double> rate_hz = {}, size_mm = {}, width_mm = {};  // of chewing
  std::string where = {};                                           // "line 3, open", for people
};

/// Movements in words: statements on lines of their own or parted by ';', after '#' a comment.
///
///   open 40 over 1.5     drop of the incisal point, mm; seconds        (open: as far as it goes)
///   close                to the bite
///   hinge 10             turn without translation, degrees
///   protrude 6 at 30     mm at the incisal point; mm/s          (retrude: mm at the condyles)
///   left 8, right 8      laterotrusion, mm at the incisal point
///   rest                 to the rest position; rest 3: that many mm apart
///   hold 0.5             seconds
///   posselt              the border movements
///   chew left 10 rate 1.4 size 15 width 5
///   set bennett 10       before the first movement; any motion parameter
///
/// Units may follow numbers (mm, s, deg, mm/s, Hz, cycles).
struct MotionScript {
  std::vector<Statement> statements;
  MotionParameters parameters;
};

/// throws: InputError naming `source`, line and word.
MotionScript parse_motion_script(const std::string& text, const std::string& source);

/// Whether the text begins as movements in words do.
bool looks_like_a_script(const std::string& text);

}  // namespace condyle
