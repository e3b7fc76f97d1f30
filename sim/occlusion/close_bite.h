#pragma once

#include <optional>
#include <vector>

#include "sim/occlusion/arches.h"
#include "sim/occlusion/elastic_layer.h"
#include "sim/occlusion/occlusion.h"

namespace condyle {

/// Both arches prepared for closing on each other.
class BiteModel {
 public:
  /// The arches' parts must outlive the model.
  BiteModel(const Arches& arches, const OcclusionSettings& settings, const Progress& progress = {});
  BiteModel(const BiteModel&) = delete;  // its contacts point to its own surfaces
  BiteModel& operator=(const BiteModel&) = delete;

  /// Lowers the mandible along the occlusal plane's normal until the layer is unloaded; absent when
  /// that takes more than 30 mm.
  std::optional<Pose> opened(const Pose& X_CM) const;

  /// Closes from a pose to equilibrium.
  RestingPose coarse(const Pose& from, int threads) const {
    return close_from(coarse_, from, threads);
  }
  RestingPose fine(const Pose& from, int threads) const { return close_from(fine_, from, threads); }

  /// A pose displaced along `left`, `front` and `up` (mm) and rotated about `up` (rad).
  Pose beside(const Pose& X_CM, const Eigen::Vector3d& left_front_up, double yaw_rad) const;

  /// Largest displacement of a point of the lower crowns between two poses, mm.
  double max_displacement_mm(const Pose& a, const Pose& b) const;

  std::vector<LayerContact::LoadedPiece> loaded_pieces(const Pose& X_CM) const {
    return fine_.loaded_pieces(X_CM);
  }
  const LayerSurface& lower_surface() const { return fine_lower_; }
  /// Total force of the springs at the condyles, N.
  double joint_force_N(const Pose& X_CM) const;

 private:
  RestingPose close_from(const LayerContact& layer, const Pose& from, int threads) const;
  /// Total potential energy with gradient and Hessian.
  LayerForce total(const LayerContact& layer, const Pose& X_CM, int threads) const;
  Pose moved(const Pose& X_CM, const Twist& x) const;

  const Arches& arches_;
  OcclusionSettings settings_;
  DistanceField upper_field_, lower_field_;
  LayerSurface fine_upper_, fine_lower_, coarse_upper_, coarse_lower_;
  LayerContact fine_, coarse_;
  Eigen::Vector3d pivot_;  // middle of the lower crowns
  std::vector<Eigen::Vector3d> crown_corners_;
};

/// Closes from the start and from poses displaced from the equilibria found. Lowest energy first;
/// poses less than 0.1 mm apart count as one. throws: InputError when the start cannot be opened.
std::vector<RestingPose> find_bites(const BiteModel& model, const Pose& start,
                                    const OcclusionSettings& settings, int& starts,
                                    const Progress& progress = {});

/// Closes from a grid of poses about the start: 2 mm sideways, 3 mm forward and back, 2 degrees
/// about the vertical axis. The six of least energy in which the arch has not slipped off, refined,
/// at least 0.1 mm apart. throws: InputError when none of them can be opened.
std::vector<RestingPose> find_bites_from_grid(const BiteModel& model, const Pose& start,
                                              const OcclusionSettings& settings, int& starts,
                                              const Progress& progress = {});

}  // namespace condyle
