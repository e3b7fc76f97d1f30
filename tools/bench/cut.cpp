// Saw cuts of the built-in patient's bones.
#include "engine/cut/cut.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/refine.h"
#include "engine/mesh/topology.h"
#include "sim/osteotomy/osteotomy.h"
#include "tools/bench/baseline/tissue_target.h"
#include "tools/bench/bench.h"
#include "tools/common.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

struct BenchCut {
  std::string name;
  const TriMesh* bone;
  std::vector<Cut> cuts;
};

/// A plane across the bone's middle, and a sheet of five bends, both of finite reach.
std::vector<BenchCut> free_cuts(const TriMesh& bone) {
  const Box box = bounding_box(bone);
  const Vector3d middle = box.center(), size = box.size();
  const std::vector<Plane> reach =
      box_planes(box.low - Vector3d::Ones(), {middle.x(), box.high.y() + 1, box.high.z() + 1});
  std::vector<Vector3d> polyline;
  for (int i = 0; i <= 5; ++i)
    polyline.push_back({middle.x() - 0.25 * size.x() + (i % 2 ? 2 : -2), middle.y(),
                        box.low.z() + i / 5. * size.z()});
  return {{"plane", &bone, {{"plane", Region::above({Vector3d::UnitY(), middle.y()}), reach, 0.6}}},
          {"sheet of 5",
           &bone,
           {{"sheet", beyond_sheet(polyline, Vector3d::UnitY(), Vector3d::UnitX()), reach, 0.6}}}};
}

Json measure_cut(const BenchCut& work, int repeats) {
  std::vector<double> wall, cpu;
  CutResult result;
  for (int i = 0; i <= repeats; ++i) {
    const Stopwatch watch;
    result = cut_bone(*work.bone, work.cuts);
    if (i == 0) continue;  // warm-up
    wall.push_back(watch.wall_ms());
    cpu.push_back(watch.cpu_ms());
  }
  double sum = result.kerf_volume_mm3;
  bool closed = true;
  for (const Piece& piece : result.pieces) {
    sum += piece.volume_mm3;
    closed = closed && inspect(piece.mesh).closed();
  }
  const double whole = signed_volume(*work.bone);
  const Quantiles times = quantiles(wall);
  return {{"name", "cut"},
          {"median", times.median},
          {"p95", times.p95},
          {"unit", "ms"},
          {"cpu_median", quantiles(cpu).median},
          {"cut", work.name},
          {"samples", repeats},
          {"triangles", work.bone->triangles.size()},
          {"pieces", result.pieces.size()},
          {"closed", closed},
          {"volume_error", std::abs(sum - whole) / whole}};
}

}  // namespace

int run_bench_cut(const BenchOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const Case patient = open_patient(options.patient, common, bar);
  bar.clear();
  const Part* mandible = patient.find(Role::mandible);
  if (!mandible) throw InputError("bench cut: the patient has no mandible");
  TriMesh finer = mandible->mesh;
  for (double edge_mm = 3; finer.triangles.size() < 100000; edge_mm *= 0.95)
    finer = refine(mandible->mesh, std::vector<double>(mandible->mesh.vertices.size(), edge_mm));
  std::vector<BenchCut> all = free_cuts(mandible->mesh);
  for (BenchCut& cut : free_cuts(finer)) all.push_back(std::move(cut));
  for (const std::string& name : osteotomy_names()) {
    const PlacedOsteotomy placed = place_osteotomy(patient, {.osteotomy = name, .kerf_mm = 0.6});
    for (const Part& part : patient.parts)
      if (part.name == placed.part) all.push_back({name, &part.mesh, placed.cuts});
  }
  Json json{{"machine", machine_json()}, {"results", Json::array()}};
  if (!common.quiet)
    fmt::print(stderr, "  {:<16}{:>10}{:>12}{:>10}{:>8}{:>10}{:>14}\n", "cut", "triangles",
               "ms (proc.)", "ms", "pieces", "closed", "volume error");
  for (const BenchCut& work : all) {
    const Json row = measure_cut(work, options.repeats);
    json["results"].push_back(row);
    if (common.quiet) continue;
    fmt::print(stderr, "  {:<16}{:>10}{:>12.1f}{:>10.1f}{:>8}{:>10}{:>14.1e}\n", work.name,
               row["triangles"].get<int>(), row["cpu_median"].get<double>(),
               row["median"].get<double>(), row["pieces"].get<int>(),
               row["closed"].get<bool>() ? "yes" : "no", row["volume_error"].get<double>());
  }
  if (common.json) fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  return 0;
}

}  // namespace condyle
