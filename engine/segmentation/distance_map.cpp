#include "engine/segmentation/distance_map.h"

#include <cassert>

#include "engine/volume/lines.h"

namespace condyle {
namespace {

/// Lower envelope of the parabolas of one line.
class LineDistances {
 public:
  void run(float* line, std::size_t n, double step_mm) {
    peak_.resize(n);
    height_.resize(n);
    start_.resize(n + 1);
    const double square = step_mm * step_mm;
    int last = -1;  // of the parabolas in the envelope
    for (std::size_t q = 0; q < n; ++q) {
      if (line[q] >= no_feature) continue;
      const double value = line[q], at = static_cast<double>(q);
      double from = -1;
      while (last >= 0) {
        const auto l = static_cast<std::size_t>(last);
        from = ((value + square * at * at) - (height_[l] + square * peak_[l] * peak_[l])) /
               (2 * square * (at - peak_[l]));
        if (from > start_[l]) break;
        --last;
      }
      ++last;
      const auto l = static_cast<std::size_t>(last);
      peak_[l] = at;
      height_[l] = value;
      start_[l] = last == 0 ? -1 : from;
    }
    if (last < 0) return;
    std::size_t l = 0;
    for (std::size_t q = 0; q < n; ++q) {
      const double at = static_cast<double>(q);
      while (l < static_cast<std::size_t>(last) && start_[l + 1] < at) ++l;
      line[q] = static_cast<float>(square * (at - peak_[l]) * (at - peak_[l]) + height_[l]);
    }
  }

 private:
  std::vector<double> peak_, height_, start_;
};

}  // namespace

void make_squared_distances(std::vector<float>& map, const std::array<int, 3>& size,
                            const Eigen::Vector3d& spacing_mm, int threads) {
  assert(map.size() == lattice_count(size));
  for (int axis = 0; axis < 3; ++axis)
    change_lines(
        map, size, axis, threads,
        [&](float* line, std::size_t n) {
          thread_local LineDistances distances;
          distances.run(line, n, spacing_mm[axis]);
        },
        [](float value) { return value; });
}

}  // namespace condyle
