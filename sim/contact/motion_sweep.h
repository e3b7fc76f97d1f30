#pragma once

#include <optional>

#include "sim/contact/collider.h"

namespace condyle {

/// A pair with one side moved along a straight path, as s goes from 0 to 1.
struct SweptPair {
  const ColliderPair* pair = nullptr;
  bool a_moves = false;        // else b
  Pose X_CS;                   // of the fixed side
  std::optional<Pose> X_DM;    // of the moving surface in its driver's frame, if it is carried
  Pose from, to;               // of the driver, X_CD
  Eigen::Vector3d pivot_D;     // centre of rotation
  double length_mm = 0;        // upper bound of the displacement of the moving surface
  double max_depth_mm = -1;    // allowed depth; negative: may not touch
  double min_distance_mm = 0;  // allowed distance, of a guided pair

  /// Sets length_mm.
  void measure();
  /// A start that is already too deep, or too near, may be left, but not deepened.
  void start_at(const PairContact& start);
  PairContact query(const Pose& X_CD, TrianglePair start, const QueryOptions& options,
                    OverlapDepth* deepest = nullptr) const;
  /// Remaining approach or deepening before the pair is blocked: changes by at most a millimetre
  /// per millimetre of motion. Negative: blocked.
  double margin(const PairContact& contact) const;
  /// Whether the whole path is free, proved from its end: `at_end` is the result there. False means
  /// undecided.
  bool clear(const PairContact& at_end) const;
};

/// Largest s up to which the path is free: exact, and nothing thicker than 0.1 mm is passed
/// through. The start counts as free.
double free_fraction(const SweptPair& swept, const PairContact& at_start, const PairContact& at_end,
                     double precision_mm);

}  // namespace condyle
