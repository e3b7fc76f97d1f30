#pragma once

#include <optional>
#include <vector>

#include "sim/occlusion/arches.h"
#include "sim/occlusion/foil.h"
#include "sim/occlusion/occlusion.h"

namespace condyle {

/// The arches made ready to be closed on each other.
class BiteModel {
 public:
  /// The arches' parts must outlive the model.
  BiteModel(const Arches& arches, const OcclusionSettings& settings, const Progress& progress = {});
  BiteModel(const BiteModel&) = delete;  // its contacts point to its own surfaces
  BiteModel& operator=(const BiteModel&) = delete;

  /// Down along the occlusal plane's normal until the foil is free; nothing when that takes more
  /// than 30 mm.
  std::optional<Pose> opened(const Pose& X_CM) const;

  /// Where it comes to rest from a pose.
  RestingPose coarse(const Pose& from, int threads) const { return settle(coarse_, from, threads); }
  RestingPose fine(const Pose& from, int threads) const { return settle(fine_, from, threads); }

  /// A small motion about the arch: along `left`, `front` and `up` (mm), and about `up` (rad).
  Pose beside(const Pose& X_CM, const Eigen::Vector3d& left_front_up, double yaw_rad) const;

  /// Farthest way of a point of the lower crowns from one pose to the other.
  double way_mm(const Pose& a, const Pose& b) const;

  std::vector<FoilContact::Pressed> pressed(const Pose& X_CM) const { return fine_.pressed(X_CM); }
  const FoilSurface& lower_surface() const { return fine_lower_; }
  /// Force of the springs at the condyles, N.
  double joint_force_N(const Pose& X_CM) const;

 private:
  RestingPose settle(const FoilContact& foil, const Pose& from, int threads) const;
  /// Work of all that acts, with its slope and curvature.
  FoilForce total(const FoilContact& foil, const Pose& X_CM, int threads) const;
  Pose moved(const Pose& X_CM, const Twist& x) const;

  const Arches& arches_;
  OcclusionSettings settings_;
  DistanceField upper_field_, lower_field_;
  FoilSurface fine_upper_, fine_lower_, coarse_upper_, coarse_lower_;
  FoilContact fine_, coarse_;
  Eigen::Vector3d pivot_;  // middle of the lower crowns
  std::vector<Eigen::Vector3d> crown_corners_;
};

/// Closes from the start and from beside what is found. The best first; poses less than 0.1 mm
/// apart count as one. throws: InputError when the start cannot be opened.
std::vector<RestingPose> find_bites(const BiteModel& model, const Pose& start,
                                    const OcclusionSettings& settings, int& starts,
                                    const Progress& progress = {});

}  // namespace condyle
