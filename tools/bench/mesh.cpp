// The two decimators on the built-in patient's surfaces.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "engine/field/decimate.h"
#include "engine/field/isosurface.h"
#include "engine/mesh/simplify.h"
#include "engine/mesh/topology.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/phantom/phantom_solid.h"
#include "tools/bench/baseline/tissue_target.h"
#include "tools/bench/bench.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

struct Surface {
  const char* name;
  TriMesh fine;
  int target = 0;  // triangles
  bool half;       // of a symmetric surface, with an open border in the plane x = 0
};

std::vector<Surface> fine_surfaces() {
  const PhantomSolid solid = make_phantom_solid();
  const auto sampled = [](const FieldRecipe& recipe, const Vector3d& low, const Vector3d& high,
                          double spacing) {
    return largest_piece(isosurface(sample_field(recipe, even_grid({low, high}, spacing))));
  };
  const ToothSolid& molar = solid.teeth.back();
  return {{"mandible, half", sampled(solid.mandible, {0, -98, -100}, {66, 2, 2}, 0.6), 25000, true},
          {"tongue, half", sampled(solid.tongue, {0, -92, -78}, {34, -24, -30}, 0.8), 3000, true},
          {"molar", sampled(molar.solid, molar.box.min(), molar.box.max(), 0.3), 2600, false}};
}

/// Distances of the vertices and triangle centres of one surface from another, mm.
std::vector<double> distances(const TriMesh& from, const TriMesh& to) {
  const TriangleTree tree(to);
  std::vector<double> all;
  for (const auto& v : from.vertices) all.push_back(tree.nearest(v).distance);
  for (const auto& t : from.triangles)
    all.push_back(
        tree.nearest((from.vertices[t[0]] + from.vertices[t[1]] + from.vertices[t[2]]) / 3)
            .distance);
  return all;
}

/// The smallest angle of each triangle, degrees: the fifth percentile.
double small_angle_deg(const TriMesh& mesh) {
  std::vector<double> smallest;
  for (const auto& t : mesh.triangles) {
    double least = 180;
    for (int k = 0; k < 3; ++k) {
      const Vector3d a = mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[k]],
                     b = mesh.vertices[t[(k + 2) % 3]] - mesh.vertices[t[k]];
      least = std::min(least, std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi);
    }
    smallest.push_back(least);
  }
  std::sort(smallest.begin(), smallest.end());
  return smallest.empty() ? 0 : smallest[smallest.size() / 20];
}

Json measure(const Surface& surface, const char* method, int repeats,
             const std::function<TriMesh()>& decimate) {
  std::vector<double> wall, cpu;
  TriMesh coarse;
  for (int i = 0; i <= repeats; ++i) {
    const Stopwatch watch;
    coarse = decimate();
    if (i == 0) continue;  // warm-up
    wall.push_back(watch.wall_ms());
    cpu.push_back(watch.cpu_ms());
  }
  std::vector<double> errors = distances(coarse, surface.fine);
  const std::vector<double> back = distances(surface.fine, coarse);
  errors.insert(errors.end(), back.begin(), back.end());
  double sum = 0;
  for (const double e : errors) sum += e;
  const Topology whole = inspect(surface.half ? with_mirror_image(coarse) : coarse);
  const Quantiles times = quantiles(wall);
  return {{"name", "decimate"},
          {"median", times.median},
          {"p95", times.p95},
          {"unit", "ms"},
          {"cpu_median", quantiles(cpu).median},
          {"method", method},
          {"surface", surface.name},
          {"samples", repeats},
          {"fine_triangles", surface.fine.triangles.size()},
          {"triangles", coarse.triangles.size()},
          {"mean_error_mm", sum / static_cast<double>(errors.size())},
          {"largest_error_mm", *std::max_element(errors.begin(), errors.end())},
          {"small_angle_deg", small_angle_deg(coarse)},
          {"closed", whole.closed()},
          {"boundary_edges", whole.boundary_edges},
          {"nonmanifold_edges", whole.nonmanifold_edges}};
}

}  // namespace

int run_bench_mesh(const BenchOptions& options, const CommonOptions& common) {
  Json json{{"machine", machine_json()}, {"results", Json::array()}};
  if (!common.quiet)
    fmt::print(stderr, "  {:<16}{:<22}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}  {}\n", "surface",
               "method", "ms", "fine", "triangles", "mean mm", "most mm", "angle", "closed");
  for (const Surface& surface : fine_surfaces())
    for (const bool own : {true, false}) {
      const Json row =
          own ? measure(
                    surface, "engine/field/decimate", options.repeats,
                    [&] { return decimated(surface.fine, {.target_triangles = surface.target}); })
              : measure(surface, "engine/mesh/simplify", options.repeats,
                        [&] { return simplify(surface.fine, surface.target); });
      json["results"].push_back(row);
      if (common.quiet) continue;
      fmt::print(stderr, "  {:<16}{:<22}{:>10.1f}{:>10}{:>10}{:>10.4f}{:>10.4f}{:>10.1f}  {}\n",
                 surface.name, row["method"].get<std::string>(), row["cpu_median"].get<double>(),
                 row["fine_triangles"].get<int>(), row["triangles"].get<int>(),
                 row["mean_error_mm"].get<double>(), row["largest_error_mm"].get<double>(),
                 row["small_angle_deg"].get<double>(), row["closed"].get<bool>() ? "yes" : "no");
    }
  if (common.json) fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  return 0;
}

}  // namespace condyle
