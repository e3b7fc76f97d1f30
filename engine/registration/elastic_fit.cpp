#include "engine/registration/elastic_fit.h"

#include <cmath>

#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

std::vector<PointPair> pairs_of(const std::vector<SurfaceMatch>& matches) {
  std::vector<PointPair> pairs;
  pairs.reserve(matches.size());
  for (const auto& match : matches)
    pairs.push_back({match.from, match.to, match.weight, match.normal});
  return pairs;
}

double rms_of(const std::vector<SurfaceMatch>& matches) {
  double sum = 0;
  for (const auto& match : matches) sum += match.distance * match.distance;
  return matches.empty() ? 0 : std::sqrt(sum / static_cast<double>(matches.size()));
}

AffineMap refine_affine(const FitSurface& moving, const FitSurface& target, const AffineMap& start,
                        int rounds, const MatchSettings& settings, const AffineStiffness& stiffness,
                        const OtherDistances& other) {
  AffineMap map = start;
  MatchSettings match = settings;
  for (int k = 0; k < rounds; ++k) {
    match.soft_mm = 8 + static_cast<double>(k) / rounds * (settings.soft_mm - 8);
    const auto next =
        affine_step(pairs_of(match_surfaces(moving, map, target, match, other)), map, stiffness);
    if (!next) break;
    map = *next;
  }
  return map;
}

/// The best of affine maps from several starts: heads differ in their proportions, and teeth look
/// like their neighbours.
AffineMap fit_affine(const FitSurface& moving, const FitSurface& target, const AffineMap& start,
                     const ElasticFitSettings& settings, const OtherDistances& other) {
  constexpr double near_mm = 2.5;
  constexpr int rough_rounds = 7;
  MatchSettings rough = settings.match;
  rough.stride = 6;
  Vector3d center = Vector3d::Zero();
  for (const auto& sample : moving.samples)
    center += sample.point / static_cast<double>(moving.samples.size());
  AffineMap best = start;
  double most = -1;
  for (const auto& variation : settings.variations) {
    AffineMap map = start;
    map.matrix = start.matrix * variation;
    map.offset = start * center - map.matrix * center;
    map = refine_affine(moving, target, map, rough_rounds, rough, settings.affine, other);
    const double share =
        explained_share(target, map, moving, near_mm, rough.threads, rough.stride) +
        explained_share(moving, map.inverse(), target, near_mm, rough.threads, rough.stride);
    if (share > most) {
      most = share;
      best = map;
    }
  }
  return refine_affine(moving, target, best, settings.affine_rounds, settings.match,
                       settings.affine, other);
}

}  // namespace

AffineMap fit_similarity(const FitSurface& moving, const FitSurface& target, const AffineMap& start,
                         const ElasticFitSettings& settings, const OtherDistances& other) {
  AffineMap map = start;
  MatchSettings match = settings.match;
  for (int k = 0; k < settings.similarity_rounds; ++k) {
    const double share = static_cast<double>(k) / settings.similarity_rounds;
    match.soft_mm = 12 + share * (settings.match.soft_mm - 12);
    match.stride = share < 0.7 ? 4 : 2;
    const auto next =
        similarity_fit(pairs_of(match_surfaces(moving, map, target, match, other)), settings.scale);
    if (!next) break;
    map = *next;
  }
  return map;
}

ElasticFit fit_stiffly(const FitSurface& moving, const FitSurface& target, const AffineMap& start,
                       const ElasticFitSettings& settings, const OtherDistances& other) {
  ElasticFit fit;
  fit.similarity = fit_similarity(moving, target, start, settings, other);
  fit.deformation.affine = fit_affine(moving, target, fit.similarity, settings, other);
  return fit;
}

void add_displacements(ElasticFit& fit, const FitSurface& moving, const FitSurface& target,
                       const ElasticFitSettings& settings, const OtherDistances& other) {
  const int threads = settings.match.threads;
  TriMesh mesh = moving.mesh;
  parallel_for(mesh.vertices.size(), threads, [&](std::size_t i) {
    mesh.vertices[i] = fit.deformation.affine * mesh.vertices[i];
  });
  for (const auto& level : settings.levels)
    for (int k = 0; k < level.rounds; ++k) {
      const TriangleTree tree = moving.pairs.tree().moved(mesh);
      MatchSettings thinned = settings.match;
      thinned.stride = level.stride;
      const auto matches = match_surfaces(moving, mesh.vertices, tree, target, thinned, other);
      fit.rms_mm = rms_of(matches);
      std::vector<Pull> pulls;
      pulls.reserve(matches.size());
      for (const auto& match : matches)
        pulls.push_back({match.now, match.to, match.normal, match.weight});
      if (pulls.empty()) break;
      DisplacementLayer layer(pulls, {.reach_mm = level.reach_mm,
                                      .spacing_mm = 0.21 * level.reach_mm,
                                      .max_controls = settings.max_controls,
                                      .stiffness = settings.stiffness / level.softness,
                                      .tangential = settings.tangential});
      parallel_for(mesh.vertices.size(), threads,
                   [&](std::size_t i) { mesh.vertices[i] = layer(mesh.vertices[i]); });
      fit.deformation.layers.push_back(std::move(layer));
    }
  const TriangleTree tree = moving.pairs.tree().moved(mesh);
  fit.rms_mm = rms_of(match_surfaces(moving, mesh.vertices, tree, target, settings.match, other));
  fit.vertices = std::move(mesh.vertices);
}

}  // namespace condyle
