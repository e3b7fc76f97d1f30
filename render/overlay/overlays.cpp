#include "render/overlay/overlays.h"

#include <Eigen/Geometry>

namespace condyle {

void add_run(LineSet& lines, const std::vector<Eigen::Vector3f>& points) {
  for (std::size_t i = 1; i < points.size(); ++i)
    lines.ends.insert(lines.ends.end(), {points[i - 1], points[i]});
}

void add_arrow(LineSet& lines, const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
  const Eigen::Vector3f along = to - from, side = 0.04f * along.norm() * along.unitOrthogonal();
  const Eigen::Vector3f neck = to - 0.1f * along;
  lines.ends.insert(lines.ends.end(), {from, to, to, neck + side, to, neck - side});
}

}  // namespace condyle
