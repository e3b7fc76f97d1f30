#pragma once

#include <Eigen/Core>
#include <span>

#include "engine/math/pose.h"
#include "engine/registration/surface_pairs.h"

namespace condyle {

struct SurfaceFitSettings {
  int max_iterations = 200;
  double kept = 0.9;  // share of the pairs, the nearest ones, that count
  int threads = 2;
  double least_cos = 0.5;         // of the angle between the normals of partners
  double small_mm = 1e-6;         // a step below it ends the fit
  int point_rounds = 0;           // first iterations: whole distances are minimised, for far starts
  double kept_first = 0.95;       // in these
  bool planes_of_points = false;  // distances along the points' normals: for noisy surfaces
};

/// Points in A registered to a surface in B.
struct SurfaceFit {
  Pose X_BA;
  double rms_mm = 0;  // of the pairs that count
  int pairs = 0;      // that count; too few of them: nothing was fitted
  int iterations = 0;
  bool converged = false;
};

/// Registration by the iterated closest point, from `start`: distances along the surface's normals
/// (or those of the points) are minimised. Bitwise deterministic for any number of threads.
/// normals_A: unit, one per point. source: Chen and Medioni, Image and Vision Computing 10, 1992;
/// trimmed as Chetverikov et al., ICPR 2002
SurfaceFit fit_to_surface(std::span<const Eigen::Vector3d> p_A,
                          std::span<const Eigen::Vector3d> normals_A, const SurfacePairs& surface_B,
                          const Pose& start = {}, const SurfaceFitSettings& settings = {});

}  // namespace condyle
