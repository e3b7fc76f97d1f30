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
  chew_right,
  face  // the jaw stays
};

/// A change of the face within a statement.
struct FaceChange {
  std::string expression = {};  // a name of sim/muscles/expression_names.h; empty: relaxed
  double strength = 1;
  bool left = true, right = true;  // sides
  bool momentary = false;          // "blink": back at once to what was before; the only change
};

/// One statement of a motion script.
struct Statement {
  Verb verb = Verb::open;
  std::optional<double> amount = {};      // mm, deg (hinge), s (hold), cycles (chew)
  std::optional<double> duration_s = {};  // "over 2"
  std::optional<double> speed_mm_s = {};  // "at 60"
  std::optional<double> rate_hz = {}, size_mm = {}, width_mm = {};  // of chewing
  std::vector<FaceChange> face = {};                                // together with the jaw
  std::optional<double> face_duration_s = {};
  std::string where = {};  // "line 3, open", for messages
};

/// A motion script: statements separated by line breaks or ';'; '#' starts a comment.
///
///   open 40 over 1.5     descent of the incisal point, mm; seconds     (open: to the maximum)
///   close                to the bite
///   hinge 10             rotation without translation, degrees
///   protrude 6 at 30     mm at the incisal point; mm/s          (retrude: mm at the condyles)
///   left 8, right 8      laterotrusion, mm at the incisal point
///   rest                 to the rest position; rest 3: with 3 mm of freeway space
///   hold 0.5             seconds
///   posselt              the border movements
///   chew left 10 rate 1.4 size 15 width 5
///   smile 0.8 over 0.5   an expression or action unit, 0 to 1, both sides; seconds
///   AU12 0.8 left and AU16 0.3 right and open 10 over 1    at the same time
///   blink, blink left    the lids close and open again
///   neutral over 1       the face relaxes; so it does at rest
///   set bennett 10       before the first movement; any motion parameter
///
/// A statement lasts until jaw and face have arrived. Units may follow numbers (mm, s, deg, mm/s,
/// Hz, cycles).
struct MotionScript {
  std::vector<Statement> statements;
  MotionParameters parameters;
};

/// throws: InputError naming `source`, line and word.
MotionScript parse_motion_script(const std::string& text, const std::string& source);

/// Whether the text starts like a motion script.
bool is_motion_script(const std::string& text);

}  // namespace condyle
