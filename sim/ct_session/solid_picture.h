#pragma once

#include <memory>
#include <vector>

#include "engine/core/progress.h"
#include "engine/volume/volume.h"
#include "sim/choice/ct_view.h"

namespace condyle {

/// A scan at a third of its resolution or more than 1.3 mm, to be drawn as a solid at once,
/// whatever the threshold.
class SolidScan {
 public:
  /// `threshold_hu`: of the bone that a picture must hold.
  SolidScan(const Volume& volume, double threshold_hu, int threads, const Progress& progress = {});

  /// The surface at a threshold, shaded, seen from a direction (see CtChoice) in parallel rays.
  CtPixels picture(int side_pixels, double threshold_hu, double turn_deg, double tilt_deg,
                   int threads = 1) const;
  const Volume& coarse() const { return coarse_; }

 private:
  void find_blocks();
  void frame_bone(double threshold_hu);
  double value(const Eigen::Vector3d& at) const;  // in steps of the lattice
  bool hits(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double threshold_hu,
            Eigen::Vector3d& at) const;

  Volume coarse_;
  std::array<int, 3> block_count_ = {0, 0, 0};
  std::vector<std::int16_t> highest_;                 // of blocks and the values next to them
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();  // of the bone, mm
  double radius_mm_ = 100;
};

}  // namespace condyle
