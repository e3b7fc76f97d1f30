#include "sim/report/motion_sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/infinity.h"
#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"

namespace condyle {
namespace {

constexpr double proof_mm = 0.1;  // a third of the thinnest wall in the real anatomy tested
constexpr double touch_mm = 0.02;
constexpr double nearest_mm = 0.01;
constexpr double same_s = 1e-9;

std::vector<double> without_repeats(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  times.erase(
      std::unique(times.begin(), times.end(), [](double a, double b) { return b - a < same_s; }),
      times.end());
  return times;
}

}  // namespace

std::vector<double> frame_times(const Motion& motion, const CheckSampling& sampling) {
  constexpr double max_frames = 3000;
  const double by_rate = std::floor(motion.duration_s * sampling.fps + 0.5) + 1;
  const int count = sampling.frames > 0     ? sampling.frames
                    : motion.duration_s > 0 ? static_cast<int>(std::clamp(by_rate, 2.0, max_frames))
                                            : 1;
  std::vector<double> times;
  for (int i = 0; i < count; ++i)
    times.push_back(count == 1 ? 0 : motion.duration_s * i / (count - 1));
  return times;
}

std::vector<PairSample> samples_of(const ContactSet& set) {
  std::vector<PairSample> samples;
  for (const auto& pair : set.pairs) {
    PairSample sample;
    sample.contact = pair;
    sample.contact.contacts.clear();
    sample.contacts = static_cast<int>(pair.contacts.size());
    sample.depth_mm = pair.depth_mm;
    sample.to_go_mm = pair.rest_depth_mm + (pair.touching ? -pair.depth_mm : pair.distance_mm);
    // Where the pair is apart at rest, ContactSet adds the depth at rest; reported is the depth at
    // the point itself.
    for (const auto& away : set.outside_rest_overlap) {
      if (away.part_a != pair.part_a || away.part_b != pair.part_b) continue;
      sample.to_go_mm = std::min(sample.to_go_mm, away.signed_distance_mm());
      if (!away.touching || pair.rest_depth_mm + away.depth_mm < pair.depth_mm) continue;
      sample.depth_mm = away.depth_mm;
      sample.was_apart = true;
    }
    samples.push_back(sample);
  }
  return samples;
}

struct MotionSampler::Watch {
  std::size_t first_touch;  // frame of first contact; the number of frames when there is none
  double limit_mm;          // to_go_mm below this exceeds the frames
};

MotionSampler::MotionSampler(const Scene& scene, const Motion& motion, double step_s)
    : scene_(scene), motion_(motion) {
  times_ = motion.sample_times;
  for (int i = 0; i * step_s < motion.duration_s; ++i) times_.push_back(i * step_s);
  times_.push_back(motion.duration_s);
  times_ = without_repeats(std::move(times_));
  std::vector<BodyPoses> at;
  for (const double time : times_) at.push_back(poses(time));
  const auto& parts = scene.patient.parts;
  for (const auto& pair : scene.contacts.at_rest().pairs) {
    const auto a = static_cast<std::size_t>(pair.part_a), b = static_cast<std::size_t>(pair.part_b);
    const Box box = bounding_box(parts[b].mesh);
    const Eigen::Vector3d center = box.center();
    const double radius = 0.5 * box.size().norm();
    std::vector<double> length = {0};
    const auto X_AB = [&](std::size_t i) {
      return pose_of(parts[a], at[i]).inverse() * pose_of(parts[b], at[i]);
    };
    Pose before = X_AB(0);
    for (std::size_t i = 1; i < at.size(); ++i) {
      const Pose now = X_AB(i);
      length.push_back(length.back() + (now * center - before * center).norm() +
                       rotation_angle(before.inverse() * now) * radius);
      before = now;
    }
    path_length_.push_back(std::move(length));
  }
}

double MotionSampler::motion_bound_mm(std::size_t pair, double t0, double t1) const {
  const auto& length = path_length_[pair];
  const auto until = [&](double t) {
    const auto next = std::upper_bound(times_.begin(), times_.end(), t);
    if (next == times_.begin()) return 0.0;
    if (next == times_.end()) return length.back();
    const auto i = static_cast<std::size_t>(next - times_.begin());
    const double s = (t - times_[i - 1]) / (times_[i] - times_[i - 1]);
    return length[i - 1] + s * (length[i] - length[i - 1]);
  };
  return until(t1) - until(t0);
}

Moment MotionSampler::at(double time_s, ContactSet& previous) const {
  previous = scene_.contacts.find(poses(time_s), &previous, 1);
  return {time_s, samples_of(previous)};
}

void MotionSampler::search(const Moment& a, const Moment& b, const std::vector<Watch>& watches,
                           std::size_t interval, ContactSet& previous,
                           std::vector<Moment>& found) const {
  if (b.time_s - a.time_s < same_s) return;
  bool news = false;
  for (std::size_t p = 0; p < watches.size() && !news; ++p) {
    const double bound = motion_bound_mm(p, a.time_s, b.time_s);
    if (bound <= proof_mm) continue;
    const double from = a.pairs[p].to_go_mm, to = b.pairs[p].to_go_mm;
    const double min_to_go = 0.5 * (from + to - bound);
    const bool before_touch = interval < watches[p].first_touch && from > 0 && to > 0;
    news = min_to_go < watches[p].limit_mm || (before_touch && min_to_go < 0);
  }
  if (!news) return;
  const Moment middle = at(0.5 * (a.time_s + b.time_s), previous);
  search(a, middle, watches, interval, previous, found);
  found.push_back(middle);
  search(middle, b, watches, interval, previous, found);
}

std::vector<Moment> MotionSampler::between(const std::vector<Moment>& frames,
                                           const std::vector<double>& reach_mm, int threads) const {
  std::vector<Watch> watches;
  for (std::size_t p = 0; p < reach_mm.size(); ++p) {
    double worst = reach_mm[p];
    std::size_t first = frames.size();
    for (std::size_t f = 0; f < frames.size(); ++f) {
      worst = std::min(worst, frames[f].pairs[p].to_go_mm);
      if (frames[f].pairs[p].contact.touching) first = std::min(first, f);
    }
    watches.push_back({first, worst - proof_mm});
  }
  std::vector<std::vector<Moment>> found(frames.size() - 1);
  parallel_for(found.size(), threads, [&](std::size_t i) {
    ContactSet previous = scene_.contacts.at_rest();
    search(frames[i], frames[i + 1], watches, i, previous, found[i]);
  });
  std::vector<Moment> all;
  for (auto& moments : found)
    for (auto& moment : moments) all.push_back(std::move(moment));
  return all;
}

Moment MotionSampler::refined(std::size_t pair, Moment before, Moment low, Moment after,
                              double limit_mm, int& samples) const {
  constexpr double golden = 0.381966;
  ContactSet previous = scene_.contacts.at_rest();
  const auto to_go = [&](const Moment& moment) { return moment.pairs[pair].to_go_mm; };
  // No moment between the two is lower.
  const auto bound = [&](const Moment& x, const Moment& y) {
    return 0.5 * (to_go(x) + to_go(y) - motion_bound_mm(pair, x.time_s, y.time_s));
  };
  while (after.time_s - before.time_s > same_s) {
    const double earlier = bound(before, low), later = bound(low, after);
    if (std::min(earlier, later) >= std::min(to_go(low), limit_mm) - nearest_mm) break;
    Moment& end = earlier < later ? before : after;
    Moment tried = at(low.time_s + golden * (end.time_s - low.time_s), previous);
    ++samples;
    if (to_go(tried) < to_go(low)) {
      (&end == &before ? after : before) = std::move(low);
      low = std::move(tried);
    } else {
      end = std::move(tried);
    }
  }
  return low;
}

MotionSampler::Nearest MotionSampler::nearest(std::size_t pair,
                                              const std::vector<Moment>& moments) const {
  constexpr std::size_t max_minima = 3;
  const auto to_go = [&](std::size_t i) { return moments[i].pairs[pair].to_go_mm; };
  std::vector<std::size_t> minima;
  const std::size_t last = moments.size() - 1;
  for (std::size_t i = 0; i <= last; ++i)
    if ((i == 0 || to_go(i) <= to_go(i - 1)) && (i == last || to_go(i) < to_go(i + 1)))
      minima.push_back(i);
  std::stable_sort(minima.begin(), minima.end(),
                   [&](std::size_t i, std::size_t j) { return to_go(i) < to_go(j); });
  minima.resize(std::min(minima.size(), max_minima));
  Nearest found;
  double least = infinity;
  for (const std::size_t i : minima) {
    found.moments.push_back(refined(pair, moments[i > 0 ? i - 1 : 0], moments[i],
                                    moments[std::min(i + 1, last)], least, found.samples));
    least = std::min(least, found.moments.back().pairs[pair].to_go_mm);
  }
  return found;
}

Moment MotionSampler::first_touch(std::size_t pair, double t0, const Moment& touching) const {
  Moment found = touching;
  ContactSet previous = scene_.contacts.at_rest();
  while (motion_bound_mm(pair, t0, found.time_s) > touch_mm && found.time_s - t0 > same_s) {
    Moment middle = at(0.5 * (t0 + found.time_s), previous);
    if (middle.pairs[pair].contact.touching)
      found = std::move(middle);
    else
      t0 = middle.time_s;
  }
  return found;
}

}  // namespace condyle
