#include "sim/contact/motion_sweep.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

// Shorter paths are tested by their ends alone. A tenth of a millimetre is a third of the thinnest
// wall in real anatomy (0.3 mm), so nothing is passed through.
constexpr double proof_step_mm = 0.1;

/// Largest s in [a, b] up to which the path is known to be free; a is free.
class MotionSweep {
 public:
  MotionSweep(const SweptPair& swept, double precision_mm, TrianglePair start)
      : swept_(swept), precision_mm_(precision_mm), start_(start) {}

  double advance(double a, double margin_a, double b, double margin_b) {
    // Free from a to low and from high to b, because margins change by at most the motion.
    const double low = a + margin_a / swept_.length_mm;
    const double high = b - std::max(margin_b, 0.0) / swept_.length_mm;
    const bool b_is_free = margin_b >= 0;
    if (b_is_free && low > high) return b;
    if ((high - low) * swept_.length_mm <= proof_step_mm) {
      if (b_is_free) return b;
      return bisect(a, margin_a, b);
    }
    const double middle = 0.5 * (low + high);
    const double margin_middle = margin_at(middle);
    const double reached = advance(a, margin_a, middle, margin_middle);
    if (margin_middle < 0 || reached < middle) return reached;
    return advance(middle, margin_middle, b, margin_b);
  }

 private:
  double margin_at(double s) {
    const Pose X = interpolate(swept_.from, swept_.to, s, swept_.pivot_D);
    const PairContact contact = swept_.query(X, start_, {.need_depth = swept_.max_depth_mm >= 0});
    start_ = {contact.triangle_a, contact.triangle_b};
    return swept_.margin(contact);
  }

  /// a is free, b is not.
  double bisect(double a, double margin_a, double b) {
    a = std::min(a + 0.999 * margin_a / swept_.length_mm, b);
    while ((b - a) * swept_.length_mm > precision_mm_) {
      const double middle = 0.5 * (a + b);
      (margin_at(middle) >= 0 ? a : b) = middle;
    }
    return a;
  }

  const SweptPair& swept_;
  double precision_mm_;
  TrianglePair start_;
};

}  // namespace

void SweptPair::measure() {
  const double shift_mm = (to * pivot_D - from * pivot_D).norm();
  const double angle = rotation_angle(from.inverse() * to);
  const Solid& moving = (a_moves ? pair->a : pair->b)->solid;
  const Eigen::Vector3d center = X_DM ? *X_DM * moving.center() : moving.center();
  length_mm = shift_mm + angle * ((center - pivot_D).norm() + moving.radius());
}

void SweptPair::start_at(const PairContact& start) {
  if (start.touching)
    max_depth_mm = std::max(max_depth_mm, start.depth_mm + min_distance_mm);
  else
    min_distance_mm = std::min(min_distance_mm, start.distance_mm);
}

PairContact SweptPair::query(const Pose& X_CD, TrianglePair start, const QueryOptions& options,
                             OverlapDepth* deepest) const {
  const Pose X_CM = X_DM ? X_CD * *X_DM : X_CD;
  return a_moves ? query_pair(*pair, X_CM, X_CS, start, options, deepest)
                 : query_pair(*pair, X_CS, X_CM, start, options, deepest);
}

double SweptPair::margin(const PairContact& contact) const {
  if (!contact.touching) return contact.distance_mm - min_distance_mm + std::max(max_depth_mm, 0.0);
  return max_depth_mm < 0 ? -1.0 : max_depth_mm - contact.depth_mm - min_distance_mm;
}

bool SweptPair::clear(const PairContact& at_end) const {
  if (length_mm < 1e-12) return margin(at_end) >= 0;
  if (margin(at_end) > length_mm) return true;
  // Near parts may move only slightly: a condyle rotates on the spot while the chin moves far.
  if (at_end.touching || !(margin(at_end) > 0) || !std::isfinite(length_mm)) return false;
  const Pose X_MD = X_DM ? X_DM->inverse() : Pose{};
  const Eigen::AngleAxisd turn((from.R.conjugate() * to.R).normalized());
  const BodyPath path{.pivot = X_MD * pivot_D,
                      .shift = X_MD.R * (to.R.conjugate() * (to * pivot_D - from * pivot_D)),
                      .turn = X_MD.R * (turn.angle() * turn.axis())};
  const Pose X_CM = X_DM ? to * *X_DM : to;
  const CollisionMesh &moves = (a_moves ? pair->a : pair->b)->surface,
                      &stays = (a_moves ? pair->b : pair->a)->surface;
  const TrianglePair start = a_moves ? TrianglePair{at_end.triangle_b, at_end.triangle_a}
                                     : TrianglePair{at_end.triangle_a, at_end.triangle_b};
  return clear_on_path(stays, X_CS, moves, X_CM, path, min_distance_mm, start);
}

double free_fraction(const SweptPair& swept, const PairContact& at_start, const PairContact& at_end,
                     double precision_mm) {
  return MotionSweep(swept, precision_mm, {at_start.triangle_a, at_start.triangle_b})
      .advance(0, swept.margin(at_start), 1, swept.margin(at_end));
}

}  // namespace condyle
