#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/collide/distance_field.h"
#include "engine/collide/surface_samples.h"
#include "engine/math/pose.h"

namespace condyle {

// Samples S of one surface in the field F of another.

/// Interpolated distances change by more than the way, but by no more than this in all.
constexpr double field_bend_mm = 0.05;

struct NearSample {
  int sample = 0;
  double distance_mm = 0;  // -reach where the field does not know it
};

/// Appends the samples nearer than reach_mm to the field's surface, or inside it, by their number.
/// `reach_mm` lies within the field's band.
void collect_near(const SurfaceSamples& samples, const DistanceField& field, const Pose& X_FS,
                  double reach_mm, std::vector<NearSample>& found);

/// The samples nearer than reach_mm to any of the places, in the samples' own coordinates.
std::vector<int> samples_around(const SurfaceSamples& samples,
                                const std::vector<Eigen::Vector3d>& places, double reach_mm);

/// No larger than the distance of the surfaces, or `most_mm` when that is smaller: bounds for far
/// bodies.
double clearance_bound(const SurfaceSamples& samples, const DistanceField& field, const Pose& X_FS,
                       double most_mm);

/// What the field says about one sample.
struct SampleLook {
  double distance_mm = 0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  // field's coordinates
  bool known = false;
  // The field's surface is met with a face at the sample. Past the end of the other body, the way
  // to its edge is no contact, and would hold up what only slides along; that edge has samples of
  // its own.
  bool faces = false;
};

/// The same where the field was asked already.
SampleLook judged(const FieldSample& here, const Eigen::Vector3d& normal_F, double spread);

/// p_F, normal_F: the sample and its outward normal in the field's coordinates.
SampleLook look_at_sample(const DistanceField& field, const Eigen::Vector3d& p_F,
                          const Eigen::Vector3d& normal_F, double spread);

}  // namespace condyle
