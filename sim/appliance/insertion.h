#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/field/mesh_field.h"
#include "engine/math/pose.h"

namespace condyle {

/// The direction within `most_tilt_deg` of `about` in which the least of a surface faces away from
/// what is seated on it. `counts`: by triangle of the surface.
Eigen::Vector3d find_insertion(const TriMesh& surface, const std::vector<char>& counts,
                               const Eigen::Vector3d& about, double most_tilt_deg);

/// What a print leaves free of teeth or bone: the least distance on the withdrawal path, less the
/// grip. Its grid has z along the direction of insertion.
class ReliefField {
 public:
  /// `on` in the coordinates of a grid G, as is `seat`; it is sampled within `box`.
  ReliefField(const TriMesh& on, const Eigen::Vector3d& seat, const Box& box, double voxel_mm,
              double band_mm, int threads);
  /// Distance of p_G from the solid that the surface sweeps, at most the band.
  double operator()(const Eigen::Vector3d& p) const;

 private:
  Eigen::Matrix3d R_FG_;
  SampledField field_;
};

}  // namespace condyle
