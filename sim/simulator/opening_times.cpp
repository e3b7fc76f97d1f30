#include "sim/simulator/opening_times.h"

#include "sim/motion/measure_pose.h"

namespace condyle {
namespace {

constexpr int opening_samples = 200, bisections = 40;

}  // namespace

double OpeningTimes::opening_at(double time_s) const {
  return measure(patient_, with_jaw_at(patient_.bodies, motion_.target(time_s))).opening_mm;
}

double OpeningTimes::sampled_opening(int sample) {
  while (sampled_mm_.size() <= static_cast<std::size_t>(sample))
    sampled_mm_.push_back(
        opening_at(motion_.duration_s * static_cast<int>(sampled_mm_.size()) / opening_samples));
  return sampled_mm_[static_cast<std::size_t>(sample)];
}

double OpeningTimes::time_of(double opening_mm) {
  double widest = 0, end = 0;
  for (int i = 0; i <= opening_samples; ++i) {
    const double opening = sampled_opening(i);
    if (opening > widest) {
      widest = opening;
      end = motion_.duration_s * i / opening_samples;
    }
    if (opening >= opening_mm) break;
  }
  double low = 0, high = end;
  for (int i = 0; i < bisections; ++i) {
    const double middle = 0.5 * (low + high);
    (opening_at(middle) < opening_mm ? low : high) = middle;
  }
  return high;
}

}  // namespace condyle
