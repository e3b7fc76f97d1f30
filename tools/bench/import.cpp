// The virtual scanner's scans, segmented, against the truth.
#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/core/error.h"
#include "engine/core/progress.h"
#include "engine/mesh/topology.h"
#include "engine/segmentation/metal_artifacts.h"
#include "engine/segmentation/scan_surfaces.h"
#include "engine/segmentation/split_bones.h"
#include "sim/ct_case/ct_case.h"
#include "sim/ct_case/fitted_seeds.h"
#include "sim/phantom/phantom.h"
#include "sim/scanner/scan_accuracy.h"
#include "tools/bench/baseline/tissue_target.h"
#include "tools/bench/bench.h"
#include "tools/common.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

constexpr double usual_noise_hu = 80;  // up to here the goals of usual scans hold
constexpr std::array<double, 3> template_errors_mm = {1, 2, 3};  // rms
constexpr std::uint64_t fitted_heads = 3;
constexpr const char* warped_surfaces = "the true surfaces, moved and warped";
constexpr const char* fitted_template = "the built-in patient, fitted";

/// One scan of the jaws, measured at several levels of noise.
struct BenchScan {
  std::string name;
  CtSettings settings;
  std::vector<double> noise_hu;
  double tooth_growth_mm = 0;
};

CtSettings jaw_settings(const Eigen::Vector3d& spacing_mm, int threads) {
  CtSettings settings;
  settings.spacing_mm = spacing_mm;
  settings.field_of_view = {{-84, -128, -104}, {84, 24, 12}};
  settings.noise_hu = 0;
  settings.threads = threads;
  return settings;
}

std::vector<BenchScan> bench_scans(int threads) {
  std::vector<BenchScan> scans;
  for (const double mm : {1.0, 0.8, 0.6})
    scans.push_back({"plain", jaw_settings({mm, mm, mm}, threads), {20, 80, 160}});
  scans.push_back({"flat voxels", jaw_settings({0.5, 0.5, 1.0}, threads), {40}});
  const auto vary = [&](const char* name) -> CtSettings& {
    scans.push_back({name, jaw_settings({0.8, 0.8, 0.8}, threads), {40}});
    return scans.back().settings;
  };
  vary("blurred").point_spread = 0.9;
  vary("fillings").fillings = true;
  CtSettings& table = vary("table");  // behind the whole head
  table.table = true;
  table.spacing_mm = {1, 1, 1};
  table.field_of_view.low.x() = -105;
  table.field_of_view.high = {105, 145, 12};
  CtSettings& dark = vary("dark marrow");  // the whole head: the end of a scan opens marrow
  dark.dark_marrow = true;
  dark.spacing_mm = {1, 1, 1};
  dark.field_of_view = CtSettings{}.field_of_view;
  vary("teeth touch");
  scans.back().tooth_growth_mm = 0.1;
  CtSettings& turned = vary("turned");
  turned.axes = (Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()) *
                 Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()))
                    .toRotationMatrix();
  return scans;
}

/// The largest resident size since the last reset, in MB; 0 where the system does not state it.
double peak_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (word == "VmHWM:") {
      double kb = 0;
      status >> kb;
      return kb / 1024;
    }
  return 0;
}
void reset_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

class ImportBench {
 public:
  ImportBench(const CommonOptions& common, const Case& patient)
      : common_(common), patient_(patient) {
    if (!common_.quiet)
      fmt::print(stderr, "  {:<14}{:<14}{:>9}{:>9}  {}\n", "", "scan", "voxel mm", "noise HU",
                 "voxels: median, p95 (goal); mm; bias mm");
  }

  void measure(const BenchScan& scan) {
    const ScannedHead head({}, scan.tooth_growth_mm);
    CtScan plain = scan_ct(head, scan.settings);
    const std::vector<std::int16_t> values = plain.volume.values;
    for (const double noise : scan.noise_hu) {
      plain.volume.values = values;
      add_noise(noise, scan.settings.seed, common_.threads, plain.volume);
      segment(scan, head, noise, plain);
    }
  }

  /// Another head, split with seeds from the built-in patient fitted to its bone.
  void measure_fit(std::uint64_t seed) {
    HeadChoice choice;
    choice.seed = seed;
    BenchScan what{.name = fmt::format("head {}", seed), .settings = {}, .noise_hu = {}};
    what.settings.spacing_mm = {1, 1, 1};
    what.settings.noise_hu = 40;
    what.settings.threads = common_.threads;
    const CtScan scan = scan_ct(ScannedHead(choice), what.settings);
    const Volume& volume = scan.volume;
    const int threads = common_.threads;
    const TissueLevels levels = tissue_levels(volume, "scan");
    BoneVoxels bone = find_bone(volume, levels, find_head(volume, levels, "scan", threads), "scan",
                                {.threads = threads});
    AnatomyScan surfaces;
    surfaces.bone =
        bone_surface(volume, bone, skull_label, {.target_triangles = 120000, .threads = threads})
            .mesh;
    const FittedSeeds fitted = fitted_seeds(fit_anatomy(surfaces, patient_, {.threads = threads}));
    const auto seeds = seed_labels(volume, bone, fitted.surfaces, {},
                                   {.template_error_mm = fitted.error_mm, .threads = threads});
    split_bones(volume, seeds, bone, threads);
    add_split(what, what.settings.noise_hu, fitted.error_mm, split_errors(scan, bone, seeds),
              fitted_template);
  }

  /// A whole head of 512 x 512 x 300 voxels, from the volume to decimated surfaces, and to a case.
  void measure_time() {
    CtSettings settings;
    settings.spacing_mm = {0.45, 0.45, 0.8};
    settings.field_of_view.low = {-114.9, -119.9, -118};
    settings.field_of_view.high =
        settings.field_of_view.low +
        settings.spacing_mm.cwiseProduct(Eigen::Vector3d(511.01, 511.01, 299.01));
    settings.threads = common_.threads;
    const Volume volume = scan_ct(ScannedHead(), settings).volume;
    measure_surfaces(volume);
    measure_case(volume);
  }

  void measure_surfaces(const Volume& scan) {
    const auto surfaces = warped_template(patient_, 2, 1);
    reset_peak();
    const Stopwatch watch;
    const auto corrected = reduce_metal_artifacts(scan, common_.threads);
    const Volume& volume = corrected ? corrected->volume : scan;
    const TissueLevels levels = tissue_levels(volume, "scan");
    const HeadRegion region = find_head(volume, levels, "scan", common_.threads);
    BoneVoxels bone = find_bone(volume, levels, region, "scan", {.threads = common_.threads});
    split_bones(volume, seed_labels(volume, bone, surfaces, {}, {.threads = common_.threads}), bone,
                common_.threads);
    const double split_s = watch.wall_ms() / 1000;
    std::vector<ScanSurface> decimated;
    for (const auto& [label, target] :
         {std::pair(skull_label, 400000), std::pair(mandible_label, 100000)})
      decimated.push_back(bone_surface(volume, bone, label,
                                       {.target_triangles = target, .threads = common_.threads}));
    decimated.push_back(skin_surface(volume, levels, region, bone.metal, "scan",
                                     {.target_triangles = 200000, .threads = common_.threads}));
    const double seconds = watch.wall_ms() / 1000, peak = peak_mb();
    Json row = time_row("given", seconds, 60, watch.cpu_ms() / 1000, peak, volume);
    row["segmentation_s"] = split_s;
    row["surfaces"] = surfaces_json(decimated);
    results_.push_back(std::move(row));
    if (!common_.quiet)
      fmt::print(stderr,
                 "  import.time   512 x 512 x 300: {:.1f} s (goal 60; processor {:.1f} s, split "
                 "after {:.1f} s), peak {:.0f} MB (goal 2048)\n",
                 seconds, watch.cpu_ms() / 1000, split_s, peak);
  }

  void measure_case(const Volume& volume) {
    reset_peak();
    const Stopwatch watch;
    const CtCase made = case_of_ct(volume, patient_, {.name = "scan", .threads = common_.threads});
    const double seconds = watch.wall_ms() / 1000, peak = peak_mb();
    Json row = time_row("fitted", seconds, 90, watch.cpu_ms() / 1000, peak, volume);
    row["parts"] = made.patient.parts.size();
    results_.push_back(std::move(row));
    if (!common_.quiet)
      fmt::print(
          stderr,
          "  import.time   the same scan to a case, with template fitting: {:.1f} s (goal 90; "
          "processor {:.1f} s), peak {:.0f} MB (goal 2048)\n",
          seconds, watch.cpu_ms() / 1000, peak);
  }

  void print_json() const {
    const Json json{{"machine", machine_json()}, {"results", results_}};
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  }

 private:
  void segment(const BenchScan& what, const ScannedHead& head, double noise_hu,
               const CtScan& scan) {
    const int threads = common_.threads;
    const auto corrected = reduce_metal_artifacts(scan.volume, threads);
    const Volume& volume = corrected ? corrected->volume : scan.volume;
    const TissueLevels levels = tissue_levels(volume, "scan");
    const HeadRegion region = find_head(volume, levels, "scan", threads);
    const BoneVoxels whole = find_bone(volume, levels, region, "scan", {.threads = threads});
    for (const double error : template_errors_mm) {
      BoneVoxels bone = whole;
      const auto seeds = seed_labels(volume, bone, warped_template(patient_, error, 1), {},
                                     {.template_error_mm = error, .threads = threads});
      split_bones(volume, seeds, bone, threads);
      add_split(what, noise_hu, error, split_errors(scan, bone, seeds));
      if (error != template_errors_mm[1]) continue;
      const SurfaceOptions all{.target_triangles = 0, .threads = threads};
      const ScanSurface upper = bone_surface(volume, bone, skull_label, all),
                        lower = bone_surface(volume, bone, mandible_label, all);
      TriMesh both = upper.mesh;  // vertices alone
      both.vertices.insert(both.vertices.end(), lower.mesh.vertices.begin(),
                           lower.mesh.vertices.end());
      const std::size_t uppers = upper.mesh.vertices.size();
      add_surface("import.bone", "bone", what, noise_hu, volume,
                  surface_errors(
                      both, volume,
                      [&](std::size_t v, const auto& p) {
                        return v < uppers ? head.upper_bone(p) : head.lower_bone(p);
                      },
                      threads));
      add_surface("import.bone", "skull", what, noise_hu, volume,
                  surface_errors(
                      upper.mesh, volume,
                      [&](std::size_t, const auto& p) { return head.upper_bone(p); }, threads));
      add_surface("import.bone", "mandible", what, noise_hu, volume,
                  surface_errors(
                      lower.mesh, volume,
                      [&](std::size_t, const auto& p) { return head.lower_bone(p); }, threads));
      const ScanSurface skin = skin_surface(volume, levels, region, bone.metal, "scan", all);
      add_surface("import.face", "skin", what, noise_hu, volume,
                  surface_errors(
                      skin.mesh, volume, [&](std::size_t, const auto& p) { return head.skin(p); },
                      threads));
    }
  }

  Json time_row(const char* seeds, double seconds, double goal, double cpu_s, double peak,
                const Volume& volume) const {
    return {{"name", "import.time"},
            {"template", seeds},
            {"median", seconds},
            {"p95", seconds},
            {"unit", "s"},
            {"goal", goal},
            {"cpu_median", cpu_s},
            {"peak_mb", peak},
            {"peak_goal_mb", 2048},
            {"size", volume.size},
            {"threads", common_.threads}};
  }
  static Json surfaces_json(const std::vector<ScanSurface>& surfaces) {
    Json all = Json::array();
    for (const ScanSurface& surface : surfaces)
      all.push_back({{"found_triangles", surface.found_triangles},
                     {"triangles", surface.mesh.triangles.size()},
                     {"closed", inspect(surface.mesh).closed()},
                     {"decimation_median_mm", surface.decimation_median_mm},
                     {"decimation_p95_mm", surface.decimation_p95_mm},
                     {"decimation_max_mm", surface.decimation_max_mm}});
    return all;
  }
  Json row(const char* name, const BenchScan& what, double noise_hu) const {
    return {{"name", name},
            {"scan", what.name},
            {"voxel_mm", std::cbrt(what.settings.spacing_mm.prod())},
            {"noise_hu", noise_hu}};
  }
  void add_surface(const char* name, const char* part, const BenchScan& what, double noise_hu,
                   const Volume& volume, const SurfaceErrors& errors) {
    const double voxel_mm = std::cbrt(volume.spacing_mm.prod());
    const bool face = std::string(name) == "import.face", usual = noise_hu <= usual_noise_hu;
    Json added = row(name, what, noise_hu);
    added["part"] = part;
    added["median_voxel"] = errors.median_mm / voxel_mm;
    added["p95_voxel"] = errors.p95_mm / voxel_mm;
    added["max_voxel"] = errors.max_mm / voxel_mm;
    added["median_mm"] = errors.median_mm;
    added["bias_mm"] = errors.bias_mm;
    added["samples"] = errors.samples;
    const bool whole = std::string(part) == "bone";  // the goals are for both bones together
    if (face) {
      added["goal_median_mm"] = 0.3;
    } else if (whole) {
      added["goal_median_voxel"] = usual ? 0.15 : 0.3;
      added["goal_p95_voxel"] = usual ? 0.5 : 0.8;
    }
    if (!common_.quiet)
      fmt::print(stderr,
                 "  {:<14}{:<14}{:>9.2f}{:>9.0f}  {:<9}{:.3f} {:.3f} ({}); {:.3f} mm; {:+.3f}\n",
                 name, what.name, voxel_mm, noise_hu, part, errors.median_mm / voxel_mm,
                 errors.p95_mm / voxel_mm,
                 face     ? "0.3 mm"
                 : !whole ? "part"
                 : usual  ? "0.15 0.5"
                          : "0.3 0.8",
                 errors.median_mm, errors.bias_mm);
    results_.push_back(std::move(added));
  }
  void add_split(const BenchScan& what, double noise_hu, double error_mm, const SplitErrors& errors,
                 const char* seeds = warped_surfaces) {
    Json added = row("import.split", what, noise_hu);
    added["seeds"] = seeds;
    added["template_error_mm"] = error_mm;
    added["wrong_percent"] = errors.wrong_percent();
    added["goal"] = 0.1;
    added["unlabelled_percent"] =
        100.0 * static_cast<double>(errors.unlabelled) / static_cast<double>(errors.voxels);
    added["seed_percent"] =
        100.0 * static_cast<double>(errors.seeds) / static_cast<double>(errors.voxels);
    added["wrong_seeds"] = errors.wrong_seeds;
    added["voxels"] = errors.voxels;
    if (!common_.quiet)
      fmt::print(stderr,
                 "  {:<14}{:<14}{:>9.2f}{:>9.0f}  template {}: wrong {:.4f} % (0.1), "
                 "unlabelled {:.3f} %, wrong seeds {}\n",
                 "import.split", what.name, added["voxel_mm"].get<double>(), noise_hu,
                 seeds == fitted_template ? "fitted" : fmt::format("off by {:.0f} mm", error_mm),
                 errors.wrong_percent(), added["unlabelled_percent"].get<double>(),
                 errors.wrong_seeds);
    results_.push_back(std::move(added));
  }

  const CommonOptions& common_;
  const Case& patient_;
  Json results_ = Json::array();
};

}  // namespace

int run_bench_import(const BenchOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const Case patient = builtin_patient(bar.callback());
  bar.clear();
  ImportBench bench(common, patient);
  if (options.part != "time")
    for (const BenchScan& scan : bench_scans(common.threads))
      if (options.part.empty() || options.part == scan.name) bench.measure(scan);
  if (options.part.empty() || options.part == "fitted")
    for (std::uint64_t seed = 1; seed <= fitted_heads; ++seed) bench.measure_fit(seed);
  if (options.part.empty() || options.part == "time") bench.measure_time();
  if (common.json) bench.print_json();
  return 0;
}

}  // namespace condyle
