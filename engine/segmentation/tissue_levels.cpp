#include "engine/segmentation/tissue_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "engine/core/error.h"

namespace condyle {
namespace {

constexpr int lowest = -1100, highest = 3100;             // HU; beyond: padding and metal
constexpr double least_soft = 0.01, least_bone = 0.0005;  // fractions of the volume

class Histogram {
 public:
  explicit Histogram(const Volume& volume) : counts_(highest - lowest + 1, 0) {
    for (const std::int16_t value : volume.values)
      ++counts_[static_cast<std::size_t>(std::clamp<int>(value, lowest, highest) - lowest)];
    total_ = static_cast<double>(volume.values.size());
  }
  double fraction(int from, int to) const {
    double sum = 0;
    for (int hu = from; hu <= to; ++hu) sum += count(hu);
    return total_ > 0 ? sum / total_ : 0;
  }
  /// The value in the middle of the most frequent 31 in an interval.
  int mode(int from, int to) const {
    constexpr int half = 15;
    int best = from;
    double most = -1;
    for (int hu = from; hu <= to; ++hu) {
      double sum = 0;
      for (int near = std::max(lowest + 1, hu - half); near <= std::min(highest, hu + half); ++near)
        sum += count(near);
      if (sum > most) most = sum, best = hu;
    }
    return best;
  }
  double mean_above(int from) const {
    double sum = 0, n = 0;
    for (int hu = from; hu <= highest; ++hu) sum += hu * count(hu), n += count(hu);
    return n > 0 ? sum / n : from;
  }

 private:
  double count(int hu) const {
    return static_cast<double>(counts_[static_cast<std::size_t>(hu - lowest)]);
  }
  std::vector<std::int64_t> counts_;
  double total_ = 0;
};

}  // namespace

TissueLevels tissue_levels(const Volume& volume, const std::string& name) {
  const Histogram histogram(volume);
  const double soft = histogram.fraction(-200, 300), bone = histogram.fraction(700, highest);
  if (soft < least_soft)
    throw InputError(fmt::format(
        "{}: {:.2f} % of the volume lies between -200 and 300 HU, where soft tissue does, at least "
        "{:g} % is needed: it holds no head, or its values are not Hounsfield units",
        name, 100 * soft, 100 * least_soft));
  if (bone < least_bone)
    throw InputError(fmt::format(
        "{}: {:.3f} % of the volume lies above 700 HU, where bone does, at least {:g} % is needed: "
        "it holds no bone, or its values are not Hounsfield units",
        name, 100 * bone, 100 * least_bone));
  TissueLevels levels;
  levels.soft = histogram.mode(-50, 150);
  levels.cortical = histogram.mean_above(700);
  if (histogram.fraction(lowest + 1, -700) > 0.001) levels.air = histogram.mode(-1050, -700);
  return levels;
}

}  // namespace condyle
