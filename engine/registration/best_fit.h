#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "engine/registration/surface_fit.h"

namespace condyle {

/// Points of a surface with their unit normals.
struct OrientedPoints {
  std::vector<Eigen::Vector3d> points, normals;

  std::size_t size() const { return points.size(); }
  /// `count` of them, evenly along the list; all where there are fewer.
  OrientedPoints thinned(std::size_t count) const;
};

/// How far points lie from a surface at a pose.
struct SurfaceResidual {
  double trimmed_mean_mm = 0;        // of the nearest `kept` of all points
  double median_mm = 0, p95_mm = 0;  // of all points, whatever the normals
  double without_partner = 0;        // fraction of the points
};

/// Unsigned distances; a point without a partner counts as `far_mm`, as does any that is farther.
SurfaceResidual surface_residual(const OrientedPoints& points_A, const SurfacePairs& surface_B,
                                 const Pose& X_BA, double far_mm, const SurfaceFitSettings& fit);

/// The given pose turned by `angle_rad` and displaced by `shift_mm` along the eight diagonals,
/// about a point of A.
std::vector<Pose> poses_about(const Pose& X_BA, const Eigen::Vector3d& center_A, double angle_rad,
                              double shift_mm);

struct BestFitSettings {
  SurfaceFitSettings fit = {.max_iterations = 60, .kept = 0.8};
  double far_mm = 3;                        // distance of a point without a partner
  std::size_t few_points = 120;             // for the choice among the starts
  std::size_t more_points = 500;            // for the best of them, and for restarts
  std::size_t refined = 4;                  // starts that are fitted with more points
  int rounds = 15;                          // of these fits
  int point_rounds = 15;                    // of whole distances before them, from the starts
  double angle_rad = 0.0873, shift_mm = 2;  // of the restarts about the best pose
};

struct RankedPose {
  Pose X_BA;
  double residual_mm = 0;  // trimmed mean
};

/// Fits from each start with few points, and from the best of them with more; the least residual
/// first. Bitwise deterministic for any number of threads, as is the next.
std::vector<RankedPose> rank_starts(const OrientedPoints& points_A, const SurfacePairs& surface_B,
                                    std::span<const Pose> starts,
                                    const BestFitSettings& settings = {});

struct BestFit {
  SurfaceFit fit;
  SurfaceResidual residual;  // of all points
};

/// The registration with the least trimmed residual of those from a start, from poses about it and
/// from further starts, ended with all points.
BestFit best_fit_to_surface(const OrientedPoints& points_A, const SurfacePairs& surface_B,
                            const Pose& start, const BestFitSettings& settings = {},
                            std::span<const Pose> further = {});

}  // namespace condyle
