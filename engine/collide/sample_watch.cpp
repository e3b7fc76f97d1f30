#include "engine/collide/sample_watch.h"

#include <algorithm>
#include <limits>

#include "engine/collide/near_samples.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double patch_mm = 0.8;

}  // namespace

/// No sample of the ball is nearer than this.
double SampleWatch::ball(const SurfaceSamples::Ball& ball, const Placing& X_FS) const {
  const Vector3d center = X_FS * ball.center;
  const FieldSample at = field_.at(center);
  // Within the band the field tells more than its bounds do.
  return (at.known ? at.distance_mm - field_bend_mm : field_.lower_bound(center)) - ball.radius -
         gap_mm_;
}

/// What the field says at p bounds the gap there, which changes by no more than the way.
double SampleWatch::least_gap(const FieldSample& at, const Vector3d& p) const {
  if (at.known) return at.distance_mm - field_bend_mm - gap_mm_;
  const double band = field_.settings().band_mm;
  if (at.distance_mm < band) return -infinity;
  const double near = field_.covers(p) ? band - field_bend_mm : -infinity;
  return std::max(near, field_.lower_bound(p)) - gap_mm_;
}

void SampleWatch::collect(const Placing& X_FS, double reach_mm) {
  patches_.clear();
  leaves_.clear();
  if (!samples_.balls.empty()) list(X_FS, reach_mm, 0);
}

void SampleWatch::list(const Placing& X_FS, double reach_mm, int index) {
  const SurfaceSamples::Ball& here = samples_.balls[index];
  const double gap = ball(here, X_FS);
  if (gap > reach_mm) return;
  if (here.right == 0 || here.radius < patch_mm) {
    const Bound bound{index, 0, static_cast<float>(gap)};
    patches_.push_back({bound, bound});
    return;
  }
  list(X_FS, reach_mm, index + 1);
  list(X_FS, reach_mm, here.right);
}

/// Lists the patch's leaves, as near as it is itself.
void SampleWatch::open(Patch& patch) {
  patch.first = static_cast<int>(leaves_.size());
  const int end = samples_.balls[patch.all.index].first + samples_.balls[patch.all.index].count;
  // Depth first: the balls of a patch follow each other, and so do their samples.
  for (int i = patch.all.index;
       i < static_cast<int>(samples_.balls.size()) && samples_.balls[i].first < end; ++i)
    if (samples_.balls[i].right == 0) leaves_.push_back({i, patch.all.look, patch.all.gap});
  patch.last = static_cast<int>(leaves_.size());
}

void SampleWatch::fold(const std::vector<double>& way) {
  const auto folded = [&](Bound& bound) {
    bound.gap -= static_cast<float>(way[bound.look]);
    bound.look = 0;
  };
  for (Bound& leaf : leaves_) folded(leaf);
  for (Patch& patch : patches_) {
    folded(patch.all);
    folded(patch.one);
  }
}

void SampleWatch::look(const Placing& X_FS, double within_mm, const std::vector<double>& way,
                       std::vector<Near>& found) {
  const int now = static_cast<int>(way.size()) - 1;
  const auto far = [&](const Bound& bound) { return bound.gap - way[bound.look] > within_mm; };
  for (Patch& patch : patches_) {
    if (far(patch.all)) continue;
    // A ball that moved by little is as near as before: its parts know more.
    if (way[patch.all.look] > samples_.balls[patch.all.index].radius) {
      patch.all.gap = static_cast<float>(ball(samples_.balls[patch.all.index], X_FS));
      patch.all.look = now;
      if (patch.all.gap > within_mm) continue;
    }
    if (patch.first < 0) open(patch);
    double nearest = infinity;
    for (int i = patch.first; i < patch.last; ++i) {
      Bound& leaf = leaves_[i];
      if (!far(leaf)) {
        const SurfaceSamples::Ball& here = samples_.balls[leaf.index];
        double gap = way[leaf.look] > 0.5 * here.radius ? ball(here, X_FS) : -infinity;
        if (gap <= within_mm) gap = std::max(gap, samples_of(here, X_FS, within_mm, found));
        leaf.gap = static_cast<float>(gap);
        leaf.look = now;
      }
      nearest = std::min(nearest, leaf.gap - way[leaf.look]);
    }
    patch.all.gap = static_cast<float>(nearest);
    patch.all.look = now;
  }
}

/// No sample of the leaf is nearer than this.
double SampleWatch::samples_of(const SurfaceSamples::Ball& leaf, const Placing& X_FS,
                               double within_mm, std::vector<Near>& found) const {
  double least = infinity;
  for (int i = leaf.first; i < leaf.first + leaf.count; ++i) {
    const double most = allowed(i);
    if (most == -infinity) continue;
    const Vector3d p = X_FS * samples_.points[i];
    const FieldSample at = field_.at(p);
    const double gap = at.distance_mm - gap_mm_;
    least = std::min(least, least_gap(at, p));
    if (gap - most <= within_mm) found.push_back({i, gap - most, at, p});
  }
  return least;
}

void SampleWatch::look_coarsely(const Placing& X_FS, const std::vector<double>& way,
                                std::vector<Near>& found) {
  const int now = static_cast<int>(way.size()) - 1;
  for (Patch& patch : patches_) {
    Bound& one = patch.one;
    if (one.gap - way[one.look] > 0) continue;
    const int i = samples_.balls[one.index].first;
    const Vector3d p = X_FS * samples_.points[i];
    const FieldSample at = field_.at(p);
    const double gap = at.distance_mm - gap_mm_, most = allowed(i);
    one.gap = static_cast<float>(least_gap(at, p));
    one.look = now;
    if (gap - most < 0) found.push_back({i, gap - most, at, p});
  }
}

}  // namespace condyle
