#pragma once

#include <optional>

#include "sim/contact/collider.h"

namespace condyle {

/// A pair of which one side is moved on a straight way, as s goes from 0 to 1.
struct Passage {
  const ColliderPair* pair = nullptr;
  bool a_moves = false;      // else b
  Pose X_CS;                 // of the side that stays
  std::optional<Pose> X_DM;  // of the moving surface in its driver's frame, if it is carried
  Pose from, to;             // of the driver, X_CD
  Eigen::Vector3d pivot_D;   // turned about
  double length_mm = 0;      // no point of the moving surface goes farther
  double limit_mm = -1;      // depth allowed; negative: may not touch at all
  double kept_mm = 0;        // distance allowed, of a guided pair

  /// Sets length_mm.
  void measure();
  /// A start that is already too deep, or too near, may leave, but come no nearer.
  void start_at(const PairContact& start);
  PairContact judged(const Pose& X_CD, TrianglePair start, const Looking& looking,
                     OverlapDepth* deepest = nullptr) const;
  /// How far the pair may still come nearer, or deeper, before it is blocked: changes by at most a
  /// millimetre per millimetre of motion. Negative: blocked.
  double margin(const PairContact& contact) const;
  /// Whether the whole way is free, told from where it ends: `at_end` is what was found there.
  /// False does not tell that it is not.
  bool clear(const PairContact& at_end) const;
};

/// Largest s up to which the way is free: exact, and nothing thicker than 0.1 mm is passed through.
/// The start is taken as free.
double free_share(const Passage& passage, const PairContact& at_start, const PairContact& at_end,
                  double precision_mm);

}  // namespace condyle
