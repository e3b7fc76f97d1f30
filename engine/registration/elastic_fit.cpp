#include "engine/registration/elastic_fit.h"

#include <cmath>

#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

std::vector<PointPair> pairs_of(const std::vector<SurfaceMatch>& matches) {
  std::vector<PointPair> pairs;
  pairs.reserve(matches.size());
  for (const auto& match : matches) pairs.push_back({match.from, match.to, match.weight});
  return pairs;
}

double rms_of(const std::vector<SurfaceMatch>& matches) {
  double sum = 0;
  for (const auto& match : matches) sum += match.distance * match.distance;
  return matches.empty() ? 0 : std::sqrt(sum / static_cast<double>(matches.size()));
}

AffineMap fit_affine(const FitSurface& moving, const FitSurface& target, const AffineMap& start,
                     const ElasticFitSettings& settings, const OtherDistance& other) {
  AffineMap map = start;
  for (int k = 0; k < settings.affine_rounds; ++k) {
    const auto pairs = pairs_of(match_surfaces(moving, map, target, settings.match, other));
    const auto next = affine_fit(pairs, start, settings.affine_pull);
    if (!next) break;
    map = *next;
  }
  return map;
}

}  // namespace

AffineMap fit_similarity(const FitSurface& moving, const FitSurface& target, const AffineMap& start,
                         const ElasticFitSettings& settings, const OtherDistance& other) {
  AffineMap map = start;
  MatchSettings match = settings.match;
  for (int k = 0; k < settings.similarity_rounds; ++k) {
    const double share = static_cast<double>(k) / settings.similarity_rounds;
    match.soft_mm = 12 + share * (settings.match.soft_mm - 12);
    const auto next =
        similarity_fit(pairs_of(match_surfaces(moving, map, target, match, other)), settings.scale);
    if (!next) break;
    map = *next;
  }
  return map;
}

ElasticFit fit_elastic(const FitSurface& moving, const FitSurface& target, const AffineMap& start,
                       const ElasticFitSettings& settings, const OtherDistance& other) {
  ElasticFit fit;
  fit.similarity = fit_similarity(moving, target, start, settings, other);
  fit.deformation.affine = fit_affine(moving, target, fit.similarity, settings, other);
  const int threads = settings.match.threads;
  TriMesh mesh = moving.mesh;
  parallel_for(mesh.vertices.size(), threads,
               [&](std::size_t i) { mesh.vertices[i] = fit.deformation.affine * mesh.vertices[i]; });
  for (const double reach : settings.reaches_mm)
    for (int k = 0; k < settings.rounds; ++k) {
      const TriangleTree tree = moving.pairs.tree().moved(mesh);
      const auto matches =
          match_surfaces(moving, mesh.vertices, tree, target, settings.match, other);
      fit.rms_mm = rms_of(matches);
      std::vector<Pull> pulls;
      pulls.reserve(matches.size());
      for (const auto& match : matches)
        pulls.push_back({match.now, match.to, match.normal, match.weight});
      if (pulls.empty()) return fit;
      DisplacementLayer layer(pulls, {.reach_mm = reach,
                                      .spacing_mm = 0.18 * reach,
                                      .max_controls = settings.max_controls,
                                      .stiffness = settings.stiffness,
                                      .tangential = settings.tangential});
      parallel_for(mesh.vertices.size(), threads,
                   [&](std::size_t i) { mesh.vertices[i] = layer(mesh.vertices[i]); });
      fit.deformation.layers.push_back(std::move(layer));
    }
  const TriangleTree tree = moving.pairs.tree().moved(mesh);
  fit.rms_mm = rms_of(match_surfaces(moving, mesh.vertices, tree, target, settings.match, other));
  fit.vertices = std::move(mesh.vertices);
  return fit;
}

}  // namespace condyle
