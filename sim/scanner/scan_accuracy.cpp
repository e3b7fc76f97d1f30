#include "sim/scanner/scan_accuracy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "engine/core/parallel.h"
#include "sim/scanner/scanner_noise.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr std::size_t most_samples = 15000;
constexpr double border_voxels = 3;

/// Whether a place lies well inside the field of view.
bool well_inside(const Volume& volume, const Vector3d& p) {
  const Vector3d at =
      (volume.axes.transpose() * (p - volume.origin)).cwiseQuotient(volume.spacing_mm);
  for (int a = 0; a < 3; ++a) {
    const double last = volume.size[static_cast<std::size_t>(a)] - 1;
    if (at[a] < border_voxels || at[a] > last - border_voxels) return false;
  }
  return true;
}

VoxelLabel bone_of(ScanTissue tissue) {
  switch (tissue) {
    case ScanTissue::skull:
    case ScanTissue::upper_teeth:
      return skull_label;
    case ScanTissue::mandible:
    case ScanTissue::lower_teeth:
      return mandible_label;
    default:
      return no_bone;
  }
}

/// A sum of waves.
class Waves {
 public:
  explicit Waves(std::uint64_t seed) {
    const auto vector = [&](std::uint64_t place) {
      Vector3d v;
      for (std::uint64_t a = 0; a < 3; ++a)
        v[static_cast<Eigen::Index>(a)] = 2 * uniform_number(seed, 3 * place + a) - 1;
      return v;
    };
    offset_ = vector(0);
    for (std::size_t n = 0; n < waves_.size(); ++n) {
      constexpr double length_mm = 60;
      waves_[n].number = vector(3 * n + 1).normalized() * 2 * std::numbers::pi / length_mm;
      waves_[n].amplitude = 1.3 * vector(3 * n + 2).normalized();
      waves_[n].phase = 2 * std::numbers::pi * uniform_number(seed, 100 + n);
    }
  }
  Vector3d operator()(const Vector3d& p) const {
    Vector3d sum = offset_;
    for (const Wave& wave : waves_)
      sum += wave.amplitude * std::sin(wave.number.dot(p) + wave.phase);
    return sum;
  }

 private:
  struct Wave {
    Vector3d number, amplitude;
    double phase = 0;
  };
  Vector3d offset_;
  std::array<Wave, 3> waves_;
};

}  // namespace

SurfaceErrors surface_errors(const TriMesh& found, const Volume& volume,
                             const TrueDistance& true_distance, int threads) {
  std::vector<std::size_t> inside;
  for (std::size_t v = 0; v < found.vertices.size(); ++v)
    if (well_inside(volume, found.vertices[v])) inside.push_back(v);
  SurfaceErrors errors;
  errors.samples = std::min(inside.size(), most_samples);
  if (errors.samples == 0) return errors;
  std::vector<double> d(errors.samples);
  parallel_for(d.size(), threads, [&](std::size_t n) {
    const std::size_t v = inside[n * inside.size() / d.size()];
    d[n] = true_distance(v, found.vertices[v]);
  });
  for (double& value : d) {
    errors.bias_mm += value / static_cast<double>(d.size());
    value = std::abs(value);
  }
  std::sort(d.begin(), d.end());
  errors.median_mm = d[d.size() / 2];
  errors.p95_mm = d[d.size() * 95 / 100];
  errors.max_mm = d.back();
  return errors;
}

SplitErrors split_errors(const CtScan& scan, const BoneVoxels& bone,
                         const std::vector<VoxelLabel>& seeds) {
  SplitErrors errors;
  const VoxelBox inside = bone.box.within(whole_box(scan.volume));
  for (int k = 0; k < inside.size[2]; ++k)
    for (int j = 0; j < inside.size[1]; ++j)
      for (int i = 0; i < inside.size[0]; ++i) {
        const std::array<int, 3> at = {inside.low[0] + i, inside.low[1] + j, inside.low[2] + k};
        const VoxelLabel truth = bone_of(scan.truth[scan.volume.index(at[0], at[1], at[2])]);
        const std::size_t q = bone.box.index(at[0] - bone.box.low[0], at[1] - bone.box.low[1],
                                             at[2] - bone.box.low[2]);
        if (truth == no_bone || bone.smooth[q] <= bone.threshold_hu) continue;
        ++errors.voxels;
        errors.seeds += seeds[q] != no_bone;
        errors.wrong_seeds += seeds[q] != no_bone && seeds[q] != truth;
        const VoxelLabel label = bone.label[q];
        if (label != skull_label && label != mandible_label)
          ++errors.unlabelled;
        else if (label != truth)
          ++errors.exchanged;
      }
  return errors;
}

std::vector<SeedSurface> warped_template(const Case& patient, double rms_mm, std::uint64_t seed) {
  std::vector<SeedSurface> surfaces;
  for (const Part& part : patient.parts) {
    if (part.role == Role::skull || part.role == Role::upper_teeth)
      surfaces.push_back({part.mesh, skull_label});
    if (part.role == Role::mandible || part.role == Role::lower_teeth)
      surfaces.push_back({part.mesh, mandible_label});
  }
  const Waves waves(seed);
  double sum = 0, count = 0;
  for (const auto& surface : surfaces)
    for (const Vector3d& p : surface.mesh.vertices) sum += waves(p).squaredNorm(), ++count;
  const double scale = count > 0 ? rms_mm / std::sqrt(sum / count) : 0;
  for (auto& surface : surfaces)
    for (Vector3d& p : surface.mesh.vertices) p += scale * waves(p);
  return surfaces;
}

}  // namespace condyle
