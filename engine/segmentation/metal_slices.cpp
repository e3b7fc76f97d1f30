#include "engine/segmentation/metal_slices.h"

#include <algorithm>

namespace condyle {
namespace {

constexpr int enamel_end_hu = 2900;
constexpr int least_saturated_hu = 2000, saturation_slack_hu = 30;

}  // namespace

int slice_axis(const Volume& volume) {
  Eigen::Index upward = 0;
  volume.axes.row(2).cwiseAbs().maxCoeff(&upward);
  return static_cast<int>(upward);
}

int metal_level(const Volume& volume) {
  if (volume.values.empty()) return enamel_end_hu;
  const int saturated = *std::max_element(volume.values.begin(), volume.values.end());
  if (saturated < enamel_end_hu && saturated >= least_saturated_hu)
    return saturated - saturation_slack_hu;  // the scanner's range ends there
  return enamel_end_hu;
}

}  // namespace condyle
