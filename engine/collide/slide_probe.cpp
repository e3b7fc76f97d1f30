#include "engine/collide/slide_probe.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/collide/near_samples.h"
#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double near_share = 0.5;       // of the band: gaps up to here are measured, not bounded
constexpr double rounding_mm = 1e-4;     // of what is kept of a look
constexpr double listed_ways_mm = 4;     // how far the body may go before lists are made anew
constexpr std::size_t most_looks = 128;  // that are told apart
}  // namespace

SlideProbe::SlideProbe(const SlidingContact& model, int threads)
    : model_(model), threads_(threads), found_(model.pairs_.size()) {
  for (const auto& pair : model.pairs_) {
    watches_.emplace_back(pair.samples->samples, pair.field->field, pair.gap_mm, pair.allowed);
    widest_mm_ = std::max(widest_mm_, pair.field->field.settings().band_mm);
  }
}

/// Written for speed: the chord of a turn instead of its angle. Samples of the fixed body count as
/// far as they are near the moving one.
double SlideProbe::way_since(const Pose& last, const Pose& X) const {
  const double chord = 2 * (X.R * last.R.conjugate()).vec().norm();
  return (X * model_.pivot_ - last * model_.pivot_).norm() +
         chord * (model_.radius_mm_ + 2 * widest_mm_) + rounding_mm;
}

/// Makes the lists good for gaps of `within_mm` at X, and X the last look.
void SlideProbe::come_to(const Pose& X, double within_mm) {
  if (looks_.empty() || within_mm + way_since(listed_at_, X) > listed_mm_) {
    listed_at_ = X;
    listed_mm_ = within_mm + listed_ways_mm;
    looks_.assign(1, X);
    ways_.assign(1, rounding_mm);
    parallel_for(watches_.size(), threads_,
                 [&](std::size_t i) { watches_[i].collect(placing(i, X), listed_mm_); });
    return;
  }
  looks_.push_back(X);
  ways_.clear();
  for (const Pose& look : looks_) ways_.push_back(way_since(look, X));
  if (looks_.size() < most_looks) return;
  for (SampleWatch& watch : watches_) watch.fold(ways_);
  looks_.assign(1, X);
  ways_.assign(1, rounding_mm);
}

Placing SlideProbe::placing(std::size_t pair, const Pose& X) const {
  return Placing(model_.pairs_[pair].samples_move ? X : X.inverse());
}

void SlideProbe::look_at(const Pose& X, double within_mm) {
  come_to(X, within_mm);
  const Eigen::Matrix3d R_X = X.R.toRotationMatrix();
  parallel_for(watches_.size(), threads_, [&](std::size_t i) {
    found_[i].clear();
    watches_[i].look(placing(i, X), within_mm, ways_, found_[i]);
  });
  candidates_.clear();
  worst_gap_ = deepest_gap_ = infinity;
  for (std::size_t i = 0; i < found_.size(); ++i) {
    const auto& pair = model_.pairs_[i];
    const SurfaceSamples& s = pair.samples->samples;
    const Eigen::Matrix3d R_FS = placing(i, X).R;
    for (const SampleWatch::Near& near : found_[i]) {
      const SampleLook look = judged(near.at, R_FS * s.normals[near.sample], s.spread[near.sample]);
      SlideCandidate& c = candidates_.emplace_back();
      c.pair = static_cast<int>(i);
      c.sample = near.sample;
      c.known = look.known;
      c.faces = look.faces;
      c.gap = near.gap_mm;
      c.point = pair.samples_move ? near.p : s.points[near.sample];
      c.gradient = pair.samples_move ? look.gradient : Vector3d(-(R_X * look.gradient));
      if (c.known) worst_gap_ = std::min(worst_gap_, c.gap);
      deepest_gap_ = std::min(deepest_gap_, c.gap);
    }
  }
}

SlideProbe::Overlap SlideProbe::overlap_at(const Pose& X) {
  come_to(X, 0);
  parallel_for(watches_.size(), threads_, [&](std::size_t i) {
    found_[i].clear();
    watches_[i].look_coarsely(placing(i, X), ways_, found_[i]);
  });
  Overlap sum;
  const Eigen::Matrix3d R_X = X.R.toRotationMatrix();
  for (std::size_t i = 0; i < found_.size(); ++i) {
    const auto& pair = model_.pairs_[i];
    Vector3d inward = Vector3d::Zero();  // by the samples' normals
    for (const SampleWatch::Near& near : found_[i]) {
      sum.depth_mm = std::max(sum.depth_mm, -near.gap_mm);
      sum.sum_mm -= near.gap_mm;
      inward -= near.gap_mm * pair.samples->samples.normals[near.sample];
    }
    sum.outward += pair.samples_move ? Vector3d(-(R_X * inward)) : inward;
  }
  return sum;
}

double SlideProbe::clearance(const Pose& X) {
  const double near = near_share * model_.band_mm_;
  look_at(X, near);
  if (deepest_gap_ <= near) return deepest_gap_;
  const Pose X_inverse = X.inverse();
  double least = infinity;
  for (const auto& pair : model_.pairs_)
    least = clearance_bound(pair.samples->samples, pair.field->field,
                            pair.samples_move ? X : X_inverse, least + pair.gap_mm) -
            pair.gap_mm;
  return std::max(least, near);
}

Twist SlideProbe::between(const Pose& X, const Pose& to) const {
  Twist x;
  const Eigen::AngleAxisd turn((to.R * X.R.conjugate()).normalized());
  double angle = turn.angle();
  if (angle > M_PI) angle -= 2 * M_PI;
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

double SlideProbe::way_of(const Twist& x) const {
  return x.head<3>().norm() + x.tail<3>().norm() / model_.rotation_length_mm_ * model_.radius_mm_;
}

}  // namespace condyle
