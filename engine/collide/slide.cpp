#include "engine/collide/slide.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "engine/collide/slide_lattice.h"
#include "engine/collide/slide_probe.h"
#include "engine/collide/slide_walk.h"
#include "engine/core/infinity.h"
#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr int max_walks = 8;
constexpr int max_restarts = 12;
constexpr double rest_mm = 0.005;
// Fraction of the band: between poses this near each other nothing can be passed through.
constexpr double near_fraction = 0.5;

bool is_finite(const Pose& X) { return X.R.coeffs().allFinite() && X.t.allFinite(); }

bool same_bits(const Pose& x, const Pose& y) { return x.R.coeffs() == y.R.coeffs() && x.t == y.t; }

bool same_place(const Pose& x, const Pose& y) {
  return (x.t - y.t).norm() < 1e-9 && rotation_angle(x.inverse() * y) < 1e-9;
}

std::uint64_t next_id() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

std::vector<SlidePair> all_pairs(std::size_t fixed, std::size_t moving) {
  std::vector<SlidePair> pairs;
  for (std::size_t f = 0; f < fixed; ++f)
    for (std::size_t m = 0; m < moving; ++m)
      pairs.push_back({static_cast<int>(f), static_cast<int>(m), 0});
  return pairs;
}

}  // namespace

ContactSurface make_contact_surface(const TriMesh& mesh, const ContactSurfaceSettings& settings,
                                    int threads, const Progress& progress) {
  SampleSettings samples = settings.samples;
  if (settings.field.region && !samples.region) samples.region = settings.field.region;
  DistanceField field = cached_field(settings.cache, mesh, settings.field, threads, progress);
  report(progress, "measuring the bone", 1);
  return {std::move(field), sample_surface(mesh, samples)};
}

SlidingContact::SlidingContact(std::vector<std::shared_ptr<const ContactSurface>> fixed,
                               std::vector<std::shared_ptr<const ContactSurface>> moving,
                               const SlideSettings& settings)
    : SlidingContact(fixed, moving, all_pairs(fixed.size(), moving.size()), settings) {}

SlidingContact::SlidingContact(std::vector<std::shared_ptr<const ContactSurface>> fixed,
                               std::vector<std::shared_ptr<const ContactSurface>> moving,
                               const std::vector<SlidePair>& pairs, const SlideSettings& settings)
    : fixed_(std::move(fixed)), moving_(std::move(moving)), settings_(settings), id_(next_id()) {
  band_mm_ = infinity;
  for (const SlidePair& pair : pairs) {
    const auto in = [](int index, std::size_t size) {
      return index >= 0 && static_cast<std::size_t>(index) < size;
    };
    if (!in(pair.fixed, fixed_.size()) || !in(pair.moving, moving_.size()))
      throw std::invalid_argument("sliding contact: a pair names a surface that is not there");
    const ContactSurface &f = *fixed_[pair.fixed], &m = *moving_[pair.moving];
    const double band = std::min(f.field.settings().band_mm, m.field.settings().band_mm);
    if (!(pair.gap_mm >= 0 && pair.gap_mm <= 0.5 * band))
      throw std::invalid_argument("sliding contact: a gap is below 0 or above half the band");
    pairs_.push_back({&m, &f, true, pair.gap_mm, pair.proves_overlap, pair.fixed, pair.moving});
    pairs_.push_back({&f, &m, false, pair.gap_mm, pair.proves_overlap, pair.fixed, pair.moving});
    band_mm_ = std::min(band_mm_, band - pair.gap_mm);
  }
  double count = 0, square = 0;
  Vector3d sum = Vector3d::Zero();
  for (const auto& m : moving_) {
    const auto n = static_cast<double>(m->samples.points.size());
    sum += n * m->samples.centroid;
    count += n;
  }
  if (count > 0) pivot_ = sum / count;
  if (settings_.pivot) pivot_ = *settings_.pivot;
  for (const auto& m : moving_)
    for (const auto& p : m->samples.points) square += (p - pivot_).squaredNorm();
  place(std::vector<Pose>(fixed_.size()), std::vector<Pose>(moving_.size()));
  if (count > 0) rotation_length_mm_ = std::max(std::sqrt(square / count), 1e-3);
  if (settings_.rotation_length_mm > 0) rotation_length_mm_ = settings_.rotation_length_mm;
}

struct SlideCache::State {
  State(const SlidingContact& model, std::uint64_t model_id, int threads)
      : id(model_id), here(model, threads), there(model, threads), nodes(model, threads) {}
  std::uint64_t id;
  SlideProbe here, there;  // along the body's path, and around the target pose
  SlideLattice nodes;
};

SlideCache::SlideCache() = default;
SlideCache::~SlideCache() = default;

SlideCache::State& SlidingContact::kept_in(SlideCache& memory, int threads) const {
  if (!memory.state_ || memory.state_->id != id_)
    memory.state_ = std::make_unique<SlideCache::State>(*this, id_, threads);
  return *memory.state_;
}

bool SlidingContact::surely_overlaps(const Pose& X_FM, SlideCache& memory, int threads) const {
  return is_finite(X_FM) && kept_in(memory, threads).there.surely_overlaps_at(X_FM);
}

void SlidingContact::place(const std::vector<Pose>& X_FS, const std::vector<Pose>& X_MS) {
  if (X_FS.size() != fixed_.size() || X_MS.size() != moving_.size())
    throw std::invalid_argument("sliding contact: not as many poses as surfaces");
  id_ = next_id();
  rest_.reset();
  bool one_rest = true;
  for (Pair& pair : pairs_) {
    pair.X_FS = X_FS[static_cast<std::size_t>(pair.fixed)];
    pair.X_MS = X_MS[static_cast<std::size_t>(pair.moving)];
    if (!pair.overlaps) continue;
    const Pose rest = pair.X_FS * pair.rest * pair.X_MS.inverse();
    one_rest &= !rest_ || same_place(rest, *rest_);
    rest_ = rest;
  }
  if (!one_rest) rest_.reset();
  radius_mm_ = 0;
  for (std::size_t m = 0; m < moving_.size(); ++m)
    for (const auto& p : moving_[m]->samples.points)
      radius_mm_ = std::max(radius_mm_, (X_MS[m] * p - pivot_).norm());
}

double SlidingContact::allowed_fraction(const Pair& pair, const Pose& X_FM) const {
  if (pair.allowed.empty()) return 0;
  if (fade_mm_ == infinity) return 1;
  // Upper bound of the displacement of any point of the moving surface.
  const auto& balls = pair.mover().samples.balls;
  if (balls.empty()) return 1;
  const Pose now = pair.between(X_FM);
  const Vector3d center = balls[0].center.cast<double>();
  const double displacement = (now * center - pair.rest * center).norm() +
                              rotation_angle(pair.rest.inverse() * now) * balls[0].radius;
  const double fraction = displacement / fade_mm_;
  return std::max(0.0, 1 - fraction * fraction);
}

void SlidingContact::allow_overlap_at(const Pose& rest, double fade_mm) {
  id_ = next_id();
  rest_ = rest;
  fade_mm_ = infinity;
  for (auto& pair : pairs_) {
    pair.allowed.clear();
    pair.rest = pair.between(rest);
  }
  SlideProbe probe(*this, 1);
  probe.look_at(rest, 0);
  for (auto& pair : pairs_) pair.allowed.assign(pair.samples->samples.points.size(), 0.0f);
  for (const SlideCandidate& c : probe.candidates())
    if (c.gap < 0)
      pairs_[c.pair].allowed[c.sample] =
          c.known ? static_cast<float>(c.gap) : -std::numeric_limits<float>::infinity();
  for (auto& pair : pairs_)
    pair.overlaps = std::any_of(pair.allowed.begin(), pair.allowed.end(),
                                [](float allowed) { return allowed < 0; });
  fade_mm_ = fade_mm;
}

double SlidingContact::depth(const Pose& X_FM, int threads) const {
  SlideProbe probe(*this, threads);
  probe.look_at(X_FM, 0);
  return std::max(0.0, -probe.worst_gap());
}

SlideResult SlidingContact::slide(const Pose& from, const Pose& target, SlideCache* memory,
                                  int threads) const {
  SlideResult out;
  out.X_FM = from;
  if (!is_finite(from) || !is_finite(target)) return out;
  SlideCache own;
  SlideCache::State& kept = kept_in(memory ? *memory : own, threads);
  SlideProbe &here = kept.here, &there = kept.there;
  const auto walk = [&](const Pose& start, const Pose& to) {
    return SlideWalk(*this, here, start, to).run();
  };
  if (settings_.friction > 0) {
    // Constraints kept from earlier steps of a walk may hold it back: the result is valid where a
    // new walk does not move.
    const auto rests = [&](const Pose& before, const SlideResult& after) {
      return after.touching &&
             here.max_displacement_mm(here.between(before, after.X_FM)) <= rest_mm;
    };
    SlideResult result = walk(from, target);
    if (rests(from, result) && !here.overlaps_at(from, settings_.slop_mm)) {
      result.X_FM = from;
      return result;
    }
    for (int again = 0; again < max_restarts && result.touching; ++again) {
      SlideResult more = walk(result.X_FM, target);
      if (rests(result.X_FM, more)) break;
      more.steps += result.steps;
      more.reached &= result.reached;
      result = std::move(more);
    }
    return result;
  }

  if (there.overlaps_at(target, settings_.slop_mm)) {
    auto& nodes = kept.nodes;
    const SlideLattice::Node start = nodes.nearest(target);
    SlideResult answer;
    std::atomic<bool> answered =
        false;  // the amount of prefetching meanwhile does not change any answer
    parallel_for(2, threads, [&](std::size_t job) {
      if (job == 1) return nodes.prefetch(target, [&] { return !answered; });
      if (start.found) {
        answer = SlideWalk(*this, there, nodes.carried(start, target), target).run();
        if (!answer.settled || !answer.reached)
          answer = SlideWalk(*this, there, start.X, target).run();
      }
      answered = true;
    });
    answer.reached &= start.reached;
    const double near = near_fraction * band_mm_;
    const auto reach =
        [&](const Pose& to) {  // whether it arrives there without passing through anything
          if (here.max_displacement_mm(here.between(from, to)) <= near)
            return std::pair(true, true);
          const SlideResult there_by_walk = walk(from, to);
          return std::pair(here.max_displacement_mm(here.between(there_by_walk.X_FM, to)) <= near,
                           there_by_walk.reached);
        };
    if (answer.settled) {
      auto [reaches, surely] = reach(answer.X_FM);
      if (!reaches) {
        std::tie(reaches, surely) = reach(start.root);
        surely &= answer.reached;
      }
      answer.reached = surely;
      if (reaches) return answer;
    }
  }
  Pose X = from;
  int steps = 0;
  bool reached = true;
  for (int k = 0; k < max_walks; ++k) {
    out = walk(X, target);
    steps += out.steps;
    reached &= out.reached;
    if (same_bits(out.X_FM, X)) break;
    X = out.X_FM;
  }
  out.steps = steps;
  out.reached = reached;
  return out;
}

}  // namespace condyle
