#include "engine/collide/slide_probe.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/collide/near_samples.h"
#include "engine/core/infinity.h"
#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double measured_fraction =
    0.5;                            // of the band: gaps up to here are measured rather than bounded
constexpr double coarse_mm = 1.5;   // size of a ball whose overlap is represented by one sample
constexpr double close_mm = 0.015;  // all samples within this distance count
constexpr double straight =
    0.01;  // deviation from 1 of a gradient's length in cells without an edge
constexpr double look_rounding_mm = 1e-4;  // rounding of the recorded values

}  // namespace

/// One query of a pair.
struct SlideProbe::Search {
  const SlidingContact::Pair& pair;
  std::vector<Seen>& seen;
  int index;
  double within, turned;
  double fraction;  // fraction of the allowance
  std::vector<SlideCandidate>& found;
  Pose X_fixed;                // pose of the samples in the fixed frame
  Eigen::Matrix3d R_FS, R_FD;  // samples in the field; field in the fixed frame
  Vector3d t_FS;
  Eigen::Matrix3f R_float;  // R_FS

  /// Written out by component: this is the most frequent query.
  template <class Vector>
  Vector3d in_field(const Vector& p) const {
    const double x = p.x(), y = p.y(), z = p.z();
    const auto& R = R_FS;
    return {R(0, 0) * x + R(0, 1) * y + R(0, 2) * z + t_FS.x(),
            R(1, 0) * x + R(1, 1) * y + R(1, 2) * z + t_FS.y(),
            R(2, 0) * x + R(2, 1) * y + R(2, 2) * z + t_FS.z()};
  }

  /// Lower bound of the gaps of the ball's samples.
  double ball(int b) {
    const SurfaceSamples::Ball& here = pair.samples->samples.balls[b];
    const bool leaf = here.right == 0;
    if (!leaf) {
      __builtin_prefetch(&pair.samples->samples.balls[here.right]);
      __builtin_prefetch(&seen[here.right]);
    }
    const Vector3d center = in_field(here.center);
    Seen& last = seen[b];
    const double displacement = (center - Vector3d(last.x, last.y, last.z)).norm() +
                                (turned - last.turned) * here.radius + look_rounding_mm;
    if (last.gap - displacement > within) return last.gap - displacement;
    double gap = -infinity;
    // A ball that moved by less than its size is about as near as before: its children have better
    // bounds.
    if (displacement > here.radius) {
      const DistanceField& field = pair.field->field;
      const DistanceField::Spot at = field.spot(center);
      // Within the band the field is more accurate than its bounds.
      gap = (at.known ? at.distance_mm - field_bend_mm : field.lower_bound(center)) - here.radius -
            pair.gap_mm;
    }
    if (gap <= within)
      gap = std::max(gap, leaf ? samples(here, center) : std::min(ball(b + 1), ball(here.right)));
    last = {static_cast<float>(center.x()), static_cast<float>(center.y()),
            static_cast<float>(center.z()), static_cast<float>(gap), static_cast<float>(turned)};
    return gap;
  }

  /// Lower bound of the gaps of a leaf's samples. Those that are not close are represented by the
  /// nearest; the others are examined at the next query, where they matter.
  double samples(const SurfaceSamples::Ball& leaf, const Vector3d& center) {
    const SurfaceSamples& s = pair.samples->samples;
    const DistanceField& field = pair.field->field;
    std::array<float, 16> gap;
    const unsigned known = field.distances(s.blocks[leaf.block], R_float, center, gap);
    double least = infinity;
    unsigned near = 0;  // a bit for each sample to examine
    for (int k = 0; k < leaf.count; ++k) {
      const int i = leaf.first + k;
      const double allowed = fraction > 0 ? fraction * static_cast<double>(pair.allowed[i]) : 0.0;
      if (allowed == -infinity) continue;
      double here = static_cast<double>(gap[k]), at_least = here - field_bend_mm;
      if (!(known >> k & 1)) {
        const DistanceField::Spot at = field.spot(in_field(s.points[i]));
        here = at_least = at.distance_mm;
        if (at.known)
          at_least -= field_bend_mm;
        else if (at.distance_mm < field.settings().band_mm)
          at_least = -infinity;
      }
      least = std::min(least, at_least - pair.gap_mm);
      gap[k] = static_cast<float>(here - pair.gap_mm - allowed);
      near |= (gap[k] <= within + look_rounding_mm ? 1u : 0u) << k;
    }
    bool turned_away = false;
    while (near != 0) {
      int nearest = std::countr_zero(near);
      for (unsigned rest = near & (near - 1); rest != 0; rest &= rest - 1)
        if (const int k = std::countr_zero(rest); gap[k] < gap[nearest]) nearest = k;
      near &= ~(1u << nearest);
      const SlideCandidate c = candidate(leaf.first + nearest);
      if (c.gap > within) continue;
      if (c.gap > close_mm && !c.faces && std::exchange(turned_away, true)) continue;
      found.push_back(c);
      if (c.gap > close_mm && c.faces) break;
    }
    return least;
  }

  /// In a cell that contains an edge of the surface, the gradient is biased towards the far side of
  /// the edge. A cell farther out has the better direction.
  Vector3d gradient(const Vector3d& p, const DistanceField::Spot& at) const {
    const DistanceField& field = pair.field->field;
    const double spacing = field.settings().spacing_mm;
    const Vector3d here = field.gradient(at);
    const double off = std::abs(here.norm() - 1);
    if (off < straight || off > 0.9 || std::abs(at.distance_mm) > spacing) return here;
    const DistanceField::Spot beyond = field.spot(p + spacing * here);
    if (!beyond.known) return here;
    const Vector3d there = field.gradient(beyond);
    return std::abs(there.norm() - 1) < off ? there : here;
  }

  SlideCandidate candidate(int sample) const {
    const SurfaceSamples& s = pair.samples->samples;
    const DistanceField& field = pair.field->field;
    const Vector3d p = in_field(s.points[sample]);
    const DistanceField::Spot at = field.spot(p);
    const SampleDistance result = classified({at.distance_mm, gradient(p, at), at.known},
                                             R_FS * s.normals[sample], s.spread[sample]);
    SlideCandidate c;
    c.pair = index;
    c.sample = sample;
    c.known = result.known;
    c.faces = result.faces;
    c.gap = at.distance_mm - pair.gap_mm;
    if (fraction > 0) c.gap -= fraction * static_cast<double>(pair.allowed[sample]);
    c.gradient = R_FD * result.gradient;
    if (!pair.samples_move) c.gradient = -c.gradient;
    c.point = X_fixed * s.points[sample];
    return c;
  }
};

SlideProbe::SlideProbe(const SlidingContact& model, int threads)
    : model_(model), threads_(threads), found_(model.pairs_.size()) {
  for (const auto& pair : model.pairs_) seen_.emplace_back(pair.samples->samples.balls.size());
}

void SlideProbe::look_at(const Pose& X, double within_mm) {
  turned_ += rotation_angle(at_.inverse() * X);
  at_ = X;
  parallel_for(seen_.size(), threads_, [&](std::size_t i) {
    const auto& pair = model_.pairs_[i];
    found_[i].clear();
    if (seen_[i].empty()) return;
    const Pose X_FS = pair.to_field(X), X_moving = X * pair.X_MS;
    Search{pair,
           seen_[i],
           static_cast<int>(i),
           within_mm,
           turned_,
           model_.allowed_fraction(pair, X),
           found_[i],
           pair.samples_move ? X_moving : pair.X_FS,
           X_FS.R.toRotationMatrix(),
           (pair.samples_move ? pair.X_FS : X_moving).R.toRotationMatrix(),
           X_FS.t,
           X_FS.R.toRotationMatrix().cast<float>()}
        .ball(0);
  });
  candidates_.clear();
  worst_gap_ = deepest_gap_ = infinity;
  for (const auto& part : found_)
    for (const SlideCandidate& c : part) {
      if (c.known) worst_gap_ = std::min(worst_gap_, c.gap);
      deepest_gap_ = std::min(deepest_gap_, c.gap);
      candidates_.push_back(c);
    }
}

template <class At>
void SlideProbe::each_overlap(const Pose& X, const At& at) const {
  std::vector<int> stack;
  for (const auto& pair : model_.pairs_) {
    const SurfaceSamples& s = pair.samples->samples;
    const DistanceField& field = pair.field->field;
    const Pose X_FS = pair.to_field(X);
    const Eigen::Matrix3d R = X_FS.R.toRotationMatrix();
    const double fraction = model_.allowed_fraction(pair, X);
    stack.assign(s.balls.empty() ? 0 : 1, 0);
    while (!stack.empty()) {
      const int index = stack.back();
      stack.pop_back();
      const SurfaceSamples::Ball& ball = s.balls[index];
      const bool stands = ball.right == 0 || ball.radius < coarse_mm;
      const Vector3d p =
          R * (stands ? s.points[ball.first] : Vector3d(ball.center.cast<double>())) + X_FS.t;
      const DistanceField::Spot here = field.spot(p);
      if (!stands) {
        const double least = here.known ? here.distance_mm - field_bend_mm : field.lower_bound(p);
        if (least - pair.gap_mm > ball.radius) continue;
        stack.push_back(ball.right);
        stack.push_back(index + 1);
        continue;
      }
      const double allowed =
          fraction > 0 ? fraction * static_cast<double>(pair.allowed[ball.first]) : 0.0;
      const double depth = allowed + pair.gap_mm - here.distance_mm;
      if (depth > 0 && !at(pair, ball.first, depth)) return;
    }
  }
}

SlideProbe::Overlap SlideProbe::overlap_at(const Pose& X) const {
  Overlap sum;
  each_overlap(X, [&](const SlidingContact::Pair& pair, int sample, double depth) {
    const Vector3d& normal = pair.samples->samples.normals[sample];
    sum.depth_mm = std::max(sum.depth_mm, depth);
    sum.sum_mm += depth;
    sum.outward += depth * (pair.samples_move ? Vector3d(-(X.R * (pair.X_MS.R * normal)))
                                              : Vector3d(pair.X_FS.R * normal));
    return true;
  });
  return sum;
}

bool SlideProbe::overlaps_at(const Pose& X, double depth_mm) {
  bool found = false;
  each_overlap(X, [&](const SlidingContact::Pair&, int, double depth) {
    found = depth > depth_mm;
    return !found;
  });
  if (found) return true;  // approximate test; otherwise the exact one
  look_at(X, 0);
  return deepest_gap_ < -depth_mm;
}

// A point of a cell is nearer to the corners than this, on average with their weights: the distance
// there differs from its interpolation by no more.
bool SlideProbe::surely_overlaps_at(const Pose& X) const {
  constexpr double cell_radius = 0.8661;  // in spacings
  bool found = false;
  each_overlap(X, [&](const SlidingContact::Pair& pair, int sample, double) {
    if (!pair.proves_overlap || pair.overlaps) return true;
    const DistanceField& field = pair.field->field;
    const DistanceField::Spot at =
        field.spot(pair.to_field(X) * pair.samples->samples.points[sample]);
    found = at.known && at.distance_mm < -cell_radius * field.settings().spacing_mm;
    return !found;
  });
  return found;
}

double SlideProbe::clearance(const Pose& X) {
  const double near = measured_fraction * model_.band_mm_;
  look_at(X, near);
  if (deepest_gap_ <= near) return deepest_gap_;
  double least = infinity;
  for (const auto& pair : model_.pairs_)
    least = clearance_bound(pair.samples->samples, pair.field->field, pair.to_field(X),
                            least + pair.gap_mm) -
            pair.gap_mm;
  return std::max(least, near);
}

Twist SlideProbe::between(const Pose& X, const Pose& to) const {
  Twist x;
  const Eigen::AngleAxisd turn((to.R * X.R.conjugate()).normalized());
  double angle = turn.angle();
  if (angle > std::numbers::pi) angle -= 2 * std::numbers::pi;
  x << to * model_.pivot_ - X * model_.pivot_,
      angle * model_.rotation_length_mm_ * Vector3d(turn.axis());
  return x;
}

Pose SlideProbe::moved(const Pose& X, const Twist& x) const {
  const Vector3d turn = x.tail<3>() / model_.rotation_length_mm_;
  const double angle = turn.norm();
  Pose out;
  out.R = angle > 0
              ? (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * X.R).normalized()
              : X.R;
  out.t = X * model_.pivot_ + x.head<3>() - out.R * model_.pivot_;
  return out;
}

double SlideProbe::max_displacement_mm(const Twist& x) const {
  return x.head<3>().norm() + x.tail<3>().norm() / model_.rotation_length_mm_ * model_.radius_mm_;
}

}  // namespace condyle
