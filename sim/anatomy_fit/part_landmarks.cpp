#include "sim/anatomy_fit/part_landmarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double near_mm = 4;  // a sample this far from the scan is not covered by it

float error_at(const FitSurface& target, const Vector3d& p, const Vector3d& normal,
               const TriangleTree* other = nullptr) {
  const auto pair = target.pairs.find(p, normal);
  if (!pair || std::abs(pair->distance) > near_mm) return -1;
  if (other && other->nearest(pair->point).distance < std::abs(pair->distance)) return -1;
  return static_cast<float>(std::abs(pair->distance));
}

}  // namespace

void measure_errors(FittedPart& part, int threads, const TriangleTree* other) {
  const auto& samples = part.moving->samples;
  part.error_mm.assign(samples.size(), -1);
  parallel_for(samples.size(), threads, [&](std::size_t i) {
    const auto& sample = samples[i];
    const auto& t = part.moving->mesh.triangles[static_cast<std::size_t>(sample.triangle)];
    const Vector3d &a = part.fit.vertices[static_cast<std::size_t>(t[0])],
                   &b = part.fit.vertices[static_cast<std::size_t>(t[1])],
                   &c = part.fit.vertices[static_cast<std::size_t>(t[2])];
    const Vector3d& share = sample.barycentric;
    part.error_mm[i] = error_at(*part.target, share[0] * a + share[1] * b + share[2] * c,
                                (b - a).cross(c - a).normalized(), other);
  });
  const auto covered =
      std::count_if(part.error_mm.begin(), part.error_mm.end(), [](float e) { return e >= 0; });
  part.covered =
      samples.empty() ? 0 : static_cast<double>(covered) / static_cast<double>(samples.size());
}

std::vector<float> errors_of(const TriMesh& carried, const FitSurface& target, int threads) {
  const std::vector<Vector3d> normals = vertex_normals(carried);
  std::vector<float> errors(carried.vertices.size());
  parallel_for(errors.size(), threads, [&](std::size_t i) {
    errors[i] = error_at(target, carried.vertices[i], normals[i]);
  });
  return errors;
}

std::map<std::string, ProposedLandmark> carried_landmarks(const FittedPart& part,
                                                          const Case& model) {
  constexpr std::size_t neighbours = 16;
  constexpr double least_cover = 0.4;
  std::map<std::string, ProposedLandmark> all;
  const auto& samples = part.moving->samples;
  for (const auto& [name, p] : model.landmarks.points) {
    if (landmark_role(name) != part.role) continue;
    ProposedLandmark mark;
    mark.point = part.fit.deformation(p);
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t i = 0; i < samples.size(); ++i)
      near.emplace_back((samples[i].point - p).squaredNorm(), i);
    const std::size_t count = std::min(neighbours, near.size());
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    double covered = 0, squares = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const float error = part.error_mm[near[k].second];
      if (error < 0) continue;
      covered += 1;
      squares += error * error;
    }
    const double share = count ? covered / static_cast<double>(count) : 0;
    mark.uncertainty_mm = covered > 0 ? std::sqrt(squares / covered) : near_mm;
    if (share < least_cover) {
      mark.doubtful = true;
      mark.outside_scan = share == 0;
      mark.reason = share == 0
                        ? "the scan has no surface near it"
                        : fmt::format("the scan has {:.0f} % of the surface near it", 100 * share);
      mark.uncertainty_mm += 4 * (1 - share);
    }
    all[name] = mark;
  }
  return all;
}

}  // namespace condyle
