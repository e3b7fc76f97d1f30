#include "engine/segmentation/half_way.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/infinity.h"
#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "engine/segmentation/volume_values.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double step_voxels = 0.25;
constexpr int reach_steps = 12;  // three voxels each way
constexpr double farthest_voxels = 1.5;
constexpr int averaging_rounds = 3;
constexpr int passes = 2;  // the second one has better normals
constexpr float undecided_weight = 1e-3f;
constexpr std::size_t chunk = 4096;  // vertices that a thread takes at a time

using Profile = std::array<double, 2 * reach_steps + 1>;  // from inside to outside

/// Place of the half-way level in steps from the middle; infinite without one.
double half_way_place(const Profile& profile, const HalfWayOptions& options) {
  double inside = -infinity, outside = infinity;
  for (int q = 0; q <= reach_steps; ++q) {
    const double value = profile[static_cast<std::size_t>(reach_steps - q)];
    if (value > inside)
      inside = value;
    else if (value < inside - (inside - options.threshold_hu) / 3 - options.drop_hu)
      break;
  }
  for (int q = 0; q <= reach_steps; ++q) {
    const double value = profile[static_cast<std::size_t>(reach_steps + q)];
    if (value < outside)
      outside = value;
    else if (value > outside + options.rise_hu)
      break;
  }
  const double level = 0.5 * (inside + outside);
  double best = infinity;
  for (int q = -reach_steps; q < reach_steps; ++q) {
    const double a = profile[static_cast<std::size_t>(q + reach_steps)],
                 b = profile[static_cast<std::size_t>(q + reach_steps + 1)];
    if (a < level || b >= level) continue;
    const double place = q + (a - level) / (a - b);
    if (std::abs(place) < std::abs(best)) best = place;
  }
  return best;
}

/// The neighbours of each vertex in a closed surface.
struct VertexNeighbours {
  std::vector<int> first, vertex;

  explicit VertexNeighbours(const TriMesh& mesh) {
    first.assign(mesh.vertices.size() + 1, 0);
    for (const auto& t : mesh.triangles)
      for (int c = 0; c < 3; ++c) ++first[static_cast<std::size_t>(t[c]) + 1];
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    vertex.resize(3 * mesh.triangles.size());
    std::vector<int> next(first.begin(), first.end() - 1);
    for (const auto& t : mesh.triangles)
      for (int c = 0; c < 3; ++c)
        vertex[static_cast<std::size_t>(next[static_cast<std::size_t>(t[c])]++)] = t[(c + 1) % 3];
  }
};

template <class Body>
void for_vertices(std::size_t count, int threads, const Body& body) {
  parallel_for((count + chunk - 1) / chunk, threads, [&](std::size_t c) {
    for (std::size_t v = c * chunk; v < std::min(count, (c + 1) * chunk); ++v) body(v);
  });
}

/// Moves of all vertices of a surface.
class HalfWayPass {
 public:
  HalfWayPass(TriMesh& mesh, const Volume& volume, const HalfWayOptions& options)
      : mesh_(mesh),
        values_(volume),
        options_(options),
        normals_(vertex_normals(mesh)),
        move_(mesh.vertices.size(), 0),
        weight_(mesh.vertices.size(), undecided_weight) {}

  /// Finds the moves, in voxels. Returns the fraction of vertices that have one.
  double find() {
    for_vertices(move_.size(), options_.threads, [&](std::size_t v) {
      const double voxel_mm = values_.step_mm(normals_[v]);
      Profile profile;
      for (int q = -reach_steps; q <= reach_steps; ++q)
        profile[static_cast<std::size_t>(q + reach_steps)] =
            values_(mesh_.vertices[v] + normals_[v] * (q * step_voxels * voxel_mm));
      const double place = half_way_place(profile, options_) * step_voxels;
      if (!(std::abs(place) < farthest_voxels)) return;
      move_[v] = static_cast<float>(place);
      weight_[v] = 1;
    });
    std::size_t decided = 0;
    for (const float w : weight_) decided += w == 1;
    return move_.empty() ? 0 : static_cast<double>(decided) / static_cast<double>(move_.size());
  }
  void average(const VertexNeighbours& neighbours) {
    std::vector<float> averaged(move_.size());
    for_vertices(move_.size(), options_.threads, [&](std::size_t v) {
      float sum = weight_[v] * move_[v], weights = weight_[v];
      for (int n = neighbours.first[v]; n < neighbours.first[v + 1]; ++n) {
        const auto other = static_cast<std::size_t>(neighbours.vertex[static_cast<std::size_t>(n)]);
        sum += weight_[other] * move_[other];
        weights += weight_[other];
      }
      averaged[v] = sum / weights;
    });
    move_.swap(averaged);
  }
  void apply() {
    for_vertices(move_.size(), options_.threads, [&](std::size_t v) {
      mesh_.vertices[v] += normals_[v] * (move_[v] * values_.step_mm(normals_[v]));
    });
  }

 private:
  TriMesh& mesh_;
  VolumeValues values_;
  const HalfWayOptions& options_;
  std::vector<Vector3d> normals_;
  std::vector<float> move_, weight_;
};

}  // namespace

double move_to_half_way(TriMesh& mesh, const Volume& volume, const HalfWayOptions& options,
                        const Progress& progress) {
  const VertexNeighbours neighbours(mesh);
  double decided = 0;
  for (int pass = 0; pass < passes; ++pass) {
    report(progress, "moving the surface to the half-way level", 1.0 * pass / passes);
    HalfWayPass moves(mesh, volume, options);
    decided = moves.find();
    for (int round = 0; round < averaging_rounds; ++round) moves.average(neighbours);
    moves.apply();
  }
  report(progress, "moving the surface to the half-way level", 1);
  return decided;
}

}  // namespace condyle
