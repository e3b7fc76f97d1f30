#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/collide/distance_field.h"
#include "engine/collide/surface_samples.h"
#include "engine/math/pose.h"

namespace condyle {

// Samples S of one surface in the field F of another.

/// Interpolated distances can change by more than the displacement, but by at most this in total.
constexpr double field_bend_mm = 0.05;

struct NearSample {
  int sample = 0;
  double distance_mm = 0;  // -reach where the field is unknown
};

/// Appends the samples nearer than reach_mm to the field's surface, or inside it, in index order.
/// `reach_mm` lies within the field's band.
void collect_near(const SurfaceSamples& samples, const DistanceField& field, const Pose& X_FS,
                  double reach_mm, std::vector<NearSample>& found);

/// The samples nearer than reach_mm to any of the places, in the samples' own coordinates.
std::vector<int> samples_around(const SurfaceSamples& samples,
                                const std::vector<Eigen::Vector3d>& places, double reach_mm);

/// Lower bound of the distance of the surfaces, at most `max_mm`: for bodies that are far apart.
double clearance_bound(const SurfaceSamples& samples, const DistanceField& field, const Pose& X_FS,
                       double max_mm);

/// Distance of one sample in the field.
struct SampleDistance {
  double distance_mm = 0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  // field's coordinates
  bool known = false;
  // The nearest surface of the field faces the sample. Beyond the end of the other body, the
  // direction to its edge is no contact normal and would obstruct sliding; that edge has samples of
  // its own.
  bool faces = false;
};

/// The same from an existing query of the field.
SampleDistance classified(const FieldSample& here, const Eigen::Vector3d& normal_F, double spread);

/// p_F, normal_F: the sample and its outward normal in the field's coordinates.
SampleDistance query_sample(const DistanceField& field, const Eigen::Vector3d& p_F,
                            const Eigen::Vector3d& normal_F, double spread);

}  // namespace condyle
