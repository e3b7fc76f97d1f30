#include "engine/field/wrap.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine/core/parallel.h"
#include "engine/field/decimate.h"
#include "engine/field/isosurface.h"
#include "engine/field/sampled_field.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/pieces.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double half = 0.5;            // winding number at the border of the inside
constexpr double clear = 0.25;          // a winding number so far from it keeps its side nearby
constexpr double plate = 0.75;          // half thickness of the thinnest plate, in spacings
constexpr double buried = 0.4;          // mean winding number beyond `half` of a surface inside
constexpr double most_samples = 6e7;    // of the grid
constexpr double fewest_mm3 = 20;       // of a part
constexpr int fewest_triangles = 8000;  // a coarser surface would lose the shape of lids and plates
constexpr int smallest = 4;             // block of samples, along an edge
constexpr int run_length = 256;         // items of a parallel task

double smooth_between(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

void parallel_runs(std::size_t count, int threads, const auto& body) {
  parallel_for((count + run_length - 1) / run_length, threads, [&](std::size_t run) {
    for (std::size_t i = run * run_length; i < std::min(count, (run + 1) * run_length); ++i)
      body(i);
  });
}

/// What a triangle of the original bounds.
struct Walls {
  std::vector<double> mean_winding;    // by triangle: of its two sides
  std::vector<double> half_thickness;  // by vertex, mm: of the plate that it becomes; 0: none
};

Walls find_walls(const TriMesh& mesh, const TriangleTree& tree, double spacing, int threads) {
  Walls walls{std::vector<double>(mesh.triangles.size(), half),
              std::vector<double>(mesh.vertices.size(), 0)};
  std::vector<double> needed(mesh.triangles.size(), 0);
  parallel_runs(mesh.triangles.size(), threads, [&](std::size_t i) {
    const auto& t = mesh.triangles[i];
    const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vector3d normal = (b - a).cross(c - a), center = (a + b + c) / 3;
    if (!(normal.norm() > 0)) return;
    // Across the surface the winding number falls by one.
    const Vector3d inward = -normal.normalized();
    walls.mean_winding[i] = tree.winding_number(center - 1e-6 * inward) + half;
    const double thinnest = plate * spacing;
    needed[i] = thinnest * smooth_between(0.3, 0.45, half - walls.mean_winding[i]);
    const auto hit = tree.ray_cast(center + 1e-6 * inward, inward, 2 * thinnest);
    if (!hit) return;
    const auto& [d, e, f] = tree.corners(hit->triangle);
    if ((e - d).cross(f - d).dot(inward) > 0)  // the other side of a plate, not a wall that crosses
      needed[i] = std::max(needed[i], thinnest - 0.5 * hit->distance);
  });
  for (std::size_t i = 0; i < needed.size(); ++i)
    for (const int v : mesh.triangles[i])
      walls.half_thickness[v] = std::max(walls.half_thickness[v], needed[i]);
  return walls;
}

/// Samples the field of a wrapped surface, negative inside.
class WrapSampler {
 public:
  WrapSampler(const TriMesh& mesh, const TriangleTree& tree, const Walls& walls, double spacing)
      : mesh_(mesh), tree_(tree), walls_(walls), spacing_(spacing), band_(3 * spacing) {}

  void fill(SampledField& field, int threads) const {
    constexpr int edge = 16;
    const Vector3i blocks = (field.size().array() + edge - 1) / edge;
    parallel_for(static_cast<std::size_t>(blocks.prod()), threads, [&](std::size_t b) {
      const int i = static_cast<int>(b);
      const Vector3i at(i / (blocks.y() * blocks.z()), i / blocks.z() % blocks.y(), i % blocks.z());
      fill_block(field, edge * at, edge);
    });
  }

 private:
  void fill_block(SampledField& field, const Vector3i& low, int edge) const {
    const Vector3i high = (low.array() + edge).matrix().cwiseMin(field.size());
    if (!(low.array() < high.array()).all()) return;
    const Vector3d center =
        field.position(low.x(), low.y(), low.z()) + Vector3d::Constant(0.5 * (edge - 1) * spacing_);
    const double radius = 0.5 * std::sqrt(3.0) * (edge - 1) * spacing_;
    // Without a surface in or near the block the winding number changes little in it.
    const double reach = radius + (plate + 1) * spacing_;
    if (tree_.nearest(center, reach).triangle < 0) {
      const double winding = tree_.winding_number(center);
      if (std::abs(winding - half) > clear) {
        const double side = winding > half ? -band_ : band_;
        for (int i = low.x(); i < high.x(); ++i)
          for (int j = low.y(); j < high.y(); ++j)
            std::fill_n(&field.values[field.index(i, j, low.z())], high.z() - low.z(),
                        static_cast<float>(side));
        return;
      }
    }
    if (edge == smallest) {
      fill_samples(field, low, high, center, radius);
      return;
    }
    for (int c = 0; c < 8; ++c)
      fill_block(field, low + edge / 2 * Vector3i(c & 1, c >> 1 & 1, c >> 2), edge / 2);
  }

  void fill_samples(SampledField& field, const Vector3i& low, const Vector3i& high,
                    const Vector3d& center, double radius) const {
    std::array<Vector3d, smallest * smallest * smallest> points;
    std::array<double, points.size()> winding;
    std::size_t count = 0;
    for (int i = low.x(); i < high.x(); ++i)
      for (int j = low.y(); j < high.y(); ++j)
        for (int k = low.z(); k < high.z(); ++k) points[count++] = field.position(i, j, k);
    tree_.winding_numbers(center, radius, {points.data(), count}, winding);
    count = 0;
    for (int i = low.x(); i < high.x(); ++i)
      for (int j = low.y(); j < high.y(); ++j)
        for (int k = low.z(); k < high.z(); ++k, ++count)
          field.values[field.index(i, j, k)] =
              static_cast<float>(value(points[count], winding[count]));
  }

  double value(const Vector3d& p, double winding) const {
    const double smooth = std::clamp(10 * band_ * (half - winding), -band_, band_);
    const SurfacePoint near = tree_.nearest(p, band_);
    if (near.triangle < 0) return smooth;
    const double distance = std::min(near.distance, std::abs(smooth));
    const double result = winding > half ? -distance : distance;
    double thickness = 0;
    for (int k = 0; k < 3; ++k)
      thickness += near.barycentric[k] * walls_.half_thickness[mesh_.triangles[near.triangle][k]];
    return thickness > 0 ? std::min(result, near.distance - thickness) : result;
  }

  const TriMesh& mesh_;
  const TriangleTree& tree_;
  const Walls& walls_;
  double spacing_, band_;
};

/// The components of at least `fewest_mm3`, cavities too; `solids` counts those that face outward.
TriMesh without_crumbs(const TriMesh& mesh, int& solids) {
  const Components components = find_components(mesh);
  const std::vector<double> volume = component_volumes(mesh, components);
  solids = static_cast<int>(
      std::count_if(volume.begin(), volume.end(), [](double v) { return v >= fewest_mm3; }));
  TriMesh out;
  std::vector<int> number(mesh.vertices.size(), -1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (std::abs(volume[components.of_triangle[t]]) < fewest_mm3) continue;
    Vector3i corner;
    for (int k = 0; k < 3; ++k) {
      int& n = number[mesh.triangles[t][k]];
      if (n < 0) {
        n = static_cast<int>(out.vertices.size());
        out.vertices.push_back(mesh.vertices[mesh.triangles[t][k]]);
      }
      corner[k] = n;
    }
    out.triangles.push_back(corner);
  }
  return out;
}

/// Centres of the triangles that count, and corners all of whose triangles do.
std::vector<Vector3d> samples_of(const TriMesh& mesh, const auto& counts) {
  std::vector<Vector3d> samples;
  std::vector<char> used(mesh.vertices.size(), 0), left_out(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const bool is_in = counts(t);
    if (is_in)
      samples.push_back((mesh.vertices[v[0]] + mesh.vertices[v[1]] + mesh.vertices[v[2]]) / 3);
    for (const int corner : v) (is_in ? used : left_out)[corner] = 1;
  }
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v] && !left_out[v]) samples.push_back(mesh.vertices[v]);
  return samples;
}

std::vector<double> distances(const std::vector<Vector3d>& points, const TriangleTree& tree,
                              int threads) {
  std::vector<double> found(points.size());
  parallel_runs(points.size(), threads,
                [&](std::size_t i) { found[i] = tree.nearest(points[i]).distance; });
  return found;
}

void measure(const TriMesh& mesh, const TriangleTree& tree, const Walls& walls, int threads,
             WrappedSurface& wrapped) {
  const auto outer =
      samples_of(mesh, [&](std::size_t t) { return walls.mean_winding[t] < half + buried; });
  const auto missed = distances(outer, TriangleTree(wrapped.mesh), threads);
  double sum = 0;
  for (const double d : missed) {
    wrapped.largest_mm = std::max(wrapped.largest_mm, d);
    sum += d;
  }
  if (!missed.empty()) wrapped.mean_mm = sum / static_cast<double>(missed.size());
  const auto all = samples_of(wrapped.mesh, [](std::size_t) { return true; });
  for (const double d : distances(all, tree, threads))
    wrapped.opening_mm = std::max(wrapped.opening_mm, d);
}

/// The grid's spacing: coarser where the surface would give too many triangles or samples, finer
/// for a small one.
double spacing_for(const TriMesh& mesh, const WrapOptions& options) {
  const double triangles = std::max<double>(options.most_triangles, 4.0 * mesh.triangles.size()),
               by_area = std::sqrt(4 * surface_area(mesh) / triangles);
  const Vector3d size = bounding_box(mesh).size();
  const double fine = std::min(options.spacing_mm, size.norm() / 100);  // of a small bone
  return std::max({fine, by_area, std::cbrt(size.prod() / most_samples)});
}

}  // namespace

WrappedSurface wrap(const TriMesh& mesh, const WrapOptions& options) {
  WrappedSurface wrapped;
  const TriangleTree tree(mesh);
  if (tree.empty()) return wrapped;
  const double spacing = wrapped.spacing_mm = spacing_for(mesh, options);
  const Walls walls = find_walls(mesh, tree, spacing, options.threads);
  const Box box = bounding_box(mesh);
  const Vector3d margin = Vector3d::Constant(4 * spacing);
  SampledField field{even_grid({box.low - margin, box.high + margin}, spacing), {}};
  field.values.resize(field.axes[0].size() * field.axes[1].size() * field.axes[2].size());
  WrapSampler(mesh, tree, walls, spacing).fill(field, options.threads);
  TriMesh surface = without_crumbs(isosurface(field), wrapped.solids);
  field = {};
  if (wrapped.solids == 0) return wrapped;
  wrapped.mesh = decimated(
      surface,
      {.target_triangles = std::max(fewest_triangles, static_cast<int>(mesh.triangles.size()))});
  measure(mesh, tree, walls, options.threads, wrapped);
  return wrapped;
}

}  // namespace condyle
