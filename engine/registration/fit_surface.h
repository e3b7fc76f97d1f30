#pragma once

#include <optional>
#include <vector>

#include "engine/registration/similarity_fit.h"
#include "engine/registration/surface_pairs.h"
#include "engine/registration/surface_samples.h"

namespace condyle {

/// A surface prepared for registration. The mesh must be welded and face outward.
struct FitSurface {
  FitSurface(TriMesh surface, int sample_count, int threads);

  TriMesh mesh;
  SurfacePairs pairs;
  std::vector<SurfaceSample> samples;  // that can be seen from outside
  std::vector<float> weights;          // of pairs on each triangle; empty: 1

  double weight_of(int triangle) const {
    return weights.empty() ? 1 : weights[static_cast<std::size_t>(triangle)];
  }
};

/// A point of the template and its partner on the target.
struct SurfaceMatch {
  int sample = -1;  // of the template's samples; -1: the pair was found from the target
  Eigen::Vector3d from = Eigen::Vector3d::Zero();    // on the template as given
  Eigen::Vector3d now = Eigen::Vector3d::Zero();     // the same point carried
  Eigen::Vector3d to = Eigen::Vector3d::Zero();      // on the target
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, of the target there
  double distance = 0;                               // mm, unsigned
  double weight = 1;
};

struct MatchSettings {
  double kept = 0.9;  // share of the pairs, the nearest ones, that count
  double farthest_mm = 30;
  double soft_mm = 4;        // a pair at this distance counts half
  double cos_normals = 0.4;  // normals of partners agree at least so far
  std::size_t stride = 1;    // 4: every fourth sample of both surfaces
  int threads = 2;
};

/// Distance of each sample of the target to what else could have caused it, such as the other bone
/// (infinite where that faces another direction); samples that lie nearer to that than to the
/// template have no partner. Empty: nothing else.
using OtherDistances = std::vector<double>;

OtherDistances distances_to(const TriangleTree& other, const FitSurface& target, int threads);

/// Pairs in both directions under an affine map from template to target.
std::vector<SurfaceMatch> match_surfaces(const FitSurface& moving, const AffineMap& map,
                                         const FitSurface& target, const MatchSettings& settings,
                                         const OtherDistances& other = {});

/// Pairs in both directions for a template whose vertices were carried; `tree` is theirs.
std::vector<SurfaceMatch> match_surfaces(const FitSurface& moving,
                                         const std::vector<Eigen::Vector3d>& carried,
                                         const TriangleTree& tree, const FitSurface& target,
                                         const MatchSettings& settings,
                                         const OtherDistances& other = {});

/// Which of the target's samples, every `stride`-th of them, lie within `near_mm` of the template
/// under a map, with agreeing normals.
std::vector<char> explained_samples(const FitSurface& target, const AffineMap& map,
                                    const FitSurface& moving, double near_mm, int threads,
                                    std::size_t stride = 1);
double explained_share(const FitSurface& target, const AffineMap& map, const FitSurface& moving,
                       double near_mm, int threads, std::size_t stride = 1);

}  // namespace condyle
