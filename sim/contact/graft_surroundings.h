#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "engine/collide/quick_distance.h"
#include "engine/math/pose.h"
#include "engine/mesh/measure.h"
#include "sim/case/case.h"

namespace condyle {

/// The nearest of all else to the graft at one place of its path.
struct Clearance {
  double mm = 0;  // at most GraftSurroundings::farthest_mm
  const std::string* part = nullptr;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
};

/// A graft and the bone and teeth of other bodies around it, all at rest. Surfaces are compared by
/// exact distances of samples of the graft (0.8 mm) and of corners of the others.
class GraftSurroundings {
 public:
  static constexpr float farthest_mm = 4;  // distances beyond are not measured

  /// `reach_mm`: how far the graft may move.
  GraftSurroundings(const Case& patient, const std::vector<BodyId>& graft, double reach_mm);

  /// `X`: the graft's displacement from its seat.
  Clearance at(const Pose& X) const;
  /// Upper bound of the displacement of any point of the graft.
  double displacement(const Pose& X) const;
  Eigen::Vector3d middle() const { return box_.center(); }

 private:
  struct Other {
    std::string name;
    QuickDistance surface;
    Box box;
    std::vector<Eigen::Vector3d> corners;
  };

  std::vector<Eigen::Vector3d> points_;
  std::vector<QuickDistance> pieces_;
  std::vector<Other> others_;
  Box box_;
};

}  // namespace condyle
