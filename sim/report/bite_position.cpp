#include "sim/report/bite_position.h"

namespace condyle {

Eigen::Vector3d bite_position(const MotionSeries& series) {
  constexpr double rounding_s = 1e-6;
  if (series.scanned_open) return series.rest.incisor;
  if (!series.borders.sagittal.empty()) return series.borders.sagittal.front();
  for (auto phase = series.phases.rbegin(); phase != series.phases.rend(); ++phase)
    if (phase->name == "closing" && series.size() > 0 &&
        series.time_s.back() >= phase->end_s - rounding_s)  // more frames may follow
      return series.measures[series.frames_of(*phase).second].incisor;
  return series.rest.incisor;
}

}  // namespace condyle
