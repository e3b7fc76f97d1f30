#include "engine/registration/surface_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The number in [0, 1) whose fraction is that of the k-th term of an additive sequence.
double fraction_of(int k, double step) {
  const double value = 0.5 + step * k;
  return value - std::floor(value);
}

bool seen_from_outside(const SurfaceSample& sample, const TriangleTree& tree) {
  constexpr double lift_mm = 0.05;
  constexpr double aside = 0.9;
  const Vector3d u = sample.normal.unitOrthogonal(), v = sample.normal.cross(u);
  const std::array<Vector3d, 5> directions = {sample.normal, sample.normal + aside * u,
                                              sample.normal - aside * u, sample.normal + aside * v,
                                              sample.normal - aside * v};
  const Vector3d from = sample.point + lift_mm * sample.normal;
  return std::any_of(directions.begin(), directions.end(),
                     [&](const Vector3d& d) { return !tree.ray_cast(from, d.normalized()); });
}

}  // namespace

std::vector<SurfaceSample> sample_surface(const TriMesh& mesh, int count) {
  // Steps of the two-dimensional golden ratio (Roberts 2018): points inside triangles do not align.
  constexpr double step_u = 0.7548776662466927, step_v = 0.5698402909980532;
  std::vector<double> area_up_to;
  area_up_to.reserve(mesh.triangles.size());
  double area = 0;
  for (const auto& t : mesh.triangles) {
    area += (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]])
                .norm();
    area_up_to.push_back(area);
  }
  std::vector<SurfaceSample> samples;
  if (!(area > 0)) return samples;
  samples.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    const double wanted = area * (k + 0.5) / count;
    const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end(), wanted);
    if (found == area_up_to.end()) continue;
    SurfaceSample sample;
    sample.triangle = static_cast<int>(found - area_up_to.begin());
    double a = fraction_of(k, step_u), b = fraction_of(k, step_v);
    if (a + b > 1) a = 1 - a, b = 1 - b;
    sample.barycentric = {1 - a - b, a, b};
    const auto& t = mesh.triangles[static_cast<std::size_t>(sample.triangle)];
    const Vector3d &p = mesh.vertices[t[0]], &q = mesh.vertices[t[1]], &r = mesh.vertices[t[2]];
    sample.point = sample.barycentric[0] * p + a * q + b * r;
    sample.normal = (q - p).cross(r - p).normalized();
    samples.push_back(sample);
  }
  return samples;
}

std::vector<SurfaceSample> outer_samples(const std::vector<SurfaceSample>& samples,
                                         const TriangleTree& tree, int threads) {
  std::vector<char> outer(samples.size());
  parallel_for(samples.size(), threads,
               [&](std::size_t i) { outer[i] = seen_from_outside(samples[i], tree) ? 1 : 0; });
  std::vector<SurfaceSample> kept;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (outer[i]) kept.push_back(samples[i]);
  return kept;
}

}  // namespace condyle
