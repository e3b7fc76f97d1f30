#include "sim/contact/free_way.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

// Ways shorter than this are judged by their ends alone. A tenth of a millimetre is a third of the
// thinnest wall met in real anatomy (0.3 mm), so nothing is passed through unseen.
constexpr double proof_step_mm = 0.1;

/// Largest s in [a, b] up to which the way is known to be free; a is free.
class FreeWay {
 public:
  FreeWay(const Passage& passage, double precision_mm, TrianglePair start)
      : passage_(passage), precision_mm_(precision_mm), start_(start) {}

  double advance(double a, double margin_a, double b, double margin_b) {
    // Free from a to low and from high to b, because margins change by at most the motion.
    const double low = a + margin_a / passage_.length_mm;
    const double high = b - std::max(margin_b, 0.0) / passage_.length_mm;
    const bool b_is_free = margin_b >= 0;
    if (b_is_free && low > high) return b;
    if ((high - low) * passage_.length_mm <= proof_step_mm) {
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
    const Pose X = interpolate(passage_.from, passage_.to, s, passage_.pivot_D);
    const PairContact contact = passage_.judged(X, start_, {.need_depth = passage_.limit_mm >= 0});
    start_ = {contact.triangle_a, contact.triangle_b};
    return passage_.margin(contact);
  }

  /// a is free, b is not.
  double bisect(double a, double margin_a, double b) {
    a = std::min(a + 0.999 * margin_a / passage_.length_mm, b);
    while ((b - a) * passage_.length_mm > precision_mm_) {
      const double middle = 0.5 * (a + b);
      (margin_at(middle) >= 0 ? a : b) = middle;
    }
    return a;
  }

  const Passage& passage_;
  double precision_mm_;
  TrianglePair start_;
};

}  // namespace

void Passage::measure() {
  const double shift_mm = (to * pivot_D - from * pivot_D).norm();
  const double angle = rotation_angle(from.inverse() * to);
  const Solid& moving = (a_moves ? pair->a : pair->b)->solid;
  const Eigen::Vector3d center = X_DM ? *X_DM * moving.center() : moving.center();
  length_mm = shift_mm + angle * ((center - pivot_D).norm() + moving.radius());
}

void Passage::start_at(const PairContact& start) {
  if (start.touching)
    limit_mm = std::max(limit_mm, start.depth_mm + kept_mm);
  else
    kept_mm = std::min(kept_mm, start.distance_mm);
}

PairContact Passage::judged(const Pose& X_CD, TrianglePair start, const Looking& looking,
                            OverlapDepth* deepest) const {
  const Pose X_CM = X_DM ? X_CD * *X_DM : X_CD;
  return a_moves ? judge(*pair, X_CM, X_CS, start, looking, deepest)
                 : judge(*pair, X_CS, X_CM, start, looking, deepest);
}

double Passage::margin(const PairContact& contact) const {
  if (!contact.touching) return contact.distance_mm - kept_mm + std::max(limit_mm, 0.0);
  return limit_mm < 0 ? -1.0 : limit_mm - contact.depth_mm - kept_mm;
}

bool Passage::clear(const PairContact& at_end) const {
  if (length_mm < 1e-12) return margin(at_end) >= 0;
  if (margin(at_end) > length_mm) return true;
  // What is near may go but a little way: a condyle turns where it is while the chin goes far.
  if (at_end.touching || !(margin(at_end) > 0) || !std::isfinite(length_mm)) return false;
  const Pose X_MD = X_DM ? X_DM->inverse() : Pose{};
  const Eigen::AngleAxisd turn((from.R.conjugate() * to.R).normalized());
  const BodyWay way{.pivot = X_MD * pivot_D,
                    .shift = X_MD.R * (to.R.conjugate() * (to * pivot_D - from * pivot_D)),
                    .turn = X_MD.R * (turn.angle() * turn.axis())};
  const Pose X_CM = X_DM ? to * *X_DM : to;
  const CollisionMesh &moves = (a_moves ? pair->a : pair->b)->surface,
                      &stays = (a_moves ? pair->b : pair->a)->surface;
  const TrianglePair start = a_moves ? TrianglePair{at_end.triangle_b, at_end.triangle_a}
                                     : TrianglePair{at_end.triangle_a, at_end.triangle_b};
  return clear_on_way(stays, X_CS, moves, X_CM, way, kept_mm, start);
}

double free_share(const Passage& passage, const PairContact& at_start, const PairContact& at_end,
                  double precision_mm) {
  return FreeWay(passage, precision_mm, {at_start.triangle_a, at_start.triangle_b})
      .advance(0, passage.margin(at_start), 1, passage.margin(at_end));
}

}  // namespace condyle
