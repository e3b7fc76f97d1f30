#pragma once

#include "engine/registration/deformation.h"
#include "engine/registration/fit_surface.h"

namespace condyle {

struct ElasticFitSettings {
  ScaleRange scale{0.8, 1.25};
  int similarity_rounds = 25;
  int affine_rounds = 10;
  AffineStiffness affine;
  std::vector<Eigen::Matrix3d> variations = {
      Eigen::Matrix3d::Identity()};  // starts of the affine map
  struct Level {
    double reach_mm;
    int rounds;
    double softness;     // divides the stiffness
    std::size_t stride;  // 3: every third sample
  };
  std::vector<Level> levels = {{220, 6, 5, 3}, {130, 7, 5, 2}, {80, 4, 2, 1}, {50, 2, 1, 1}};
  double stiffness = 0.6;
  double tangential = 0.1;
  int max_controls = 600;
  MatchSettings match;
};

/// A template carried onto a target.
struct ElasticFit {
  AffineMap similarity;
  Deformation deformation;
  std::vector<Eigen::Vector3d> vertices;  // of the template's mesh, carried
  double rms_mm = 0;                      // of the pairs that count
};

/// Trimmed iterative closest points in both directions from `start`, ever the nearer pairs.
AffineMap fit_similarity(const FitSurface& moving, const FitSurface& target, const AffineMap& start,
                         const ElasticFitSettings& settings, const OtherDistances& other = {});

/// Similarity, then the affine map: without displacements.
ElasticFit fit_stiffly(const FitSurface& moving, const FitSurface& target, const AffineMap& start,
                       const ElasticFitSettings& settings, const OtherDistances& other = {});

/// Adds smooth displacements, from coarse to fine, to a stiff fit. Deterministic, as all here: the
/// same bits for any number of threads.
/// source: Besl and McKay 1992; Amberg et al., CVPR 2007, for the order from stiff to soft
void add_displacements(ElasticFit& fit, const FitSurface& moving, const FitSurface& target,
                       const ElasticFitSettings& settings, const OtherDistances& other = {});

}  // namespace condyle
