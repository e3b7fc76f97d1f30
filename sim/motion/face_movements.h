#pragma once

#include <vector>

#include "sim/motion/motion.h"
#include "sim/motion/motion_script.h"
#include "sim/muscles/expression.h"

namespace condyle {

/// Builds the expressions of a motion from the statements of its script.
class FaceMovements {
 public:
  /// Changes the face from `start_s` on, not before the last change has ended: an expression
  /// replaces what its sides showed, an action unit changes only itself; "rest" relaxes the face. A
  /// blink closes the lids in 0.1 s and opens them in 0.17 s, as in LifeSigns, to where they were.
  void add(const Statement& statement, double start_s);

  /// When the last change ends; 0: there is none.
  double end_s() const { return keys_.back().time_s; }
  /// Adds the expressions, if there are any, to a motion of the patient. throws: InputError where
  /// the patient has no muscles of the face.
  void finish(Motion& motion, const Case& patient) const;

 private:
  std::vector<ExpressionKey> keys_{1};
};

}  // namespace condyle
