// Landmarks proposed by the fit of the built-in patient, against the truth of other heads.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "sim/anatomy_fit/anatomy_fit.h"
#include "sim/phantom/phantom.h"
#include "tools/bench/baseline/head_surfaces.h"
#include "tools/bench/bench.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

/// What a scanner shows of a head.
struct LandmarkScan {
  const char* name;
  HeadPopulation population;
  AnatomyScan (*scan)(const HeadSurfaces& head);
};

AnatomyScan cut_scan(const HeadSurfaces& head, double low_mm, double high_mm) {
  AnatomyScan scan;
  scan.bone = scanned_between(head.bone(), head, low_mm, high_mm);
  return scan;
}

constexpr double no_limit_mm = 1000, orbits_mm = 45, chin_mm = -62;

AnatomyScan whole_scan(const HeadSurfaces& head) {
  return cut_scan(head, -no_limit_mm, no_limit_mm);
}
AnatomyScan scan_below_orbits(const HeadSurfaces& head) {
  return cut_scan(head, -no_limit_mm, orbits_mm);
}
AnatomyScan scan_above_chin(const HeadSurfaces& head) {
  return cut_scan(head, chin_mm, no_limit_mm);
}
AnatomyScan scan_with_skin(const HeadSurfaces& head) {
  AnatomyScan scan = whole_scan(head);
  scan.skin = head.skin;
  return scan;
}
AnatomyScan scan_of_jaw(const HeadSurfaces& head) {
  AnatomyScan scan;
  scan.mandible = head.mandible;
  return scan;
}

const std::vector<LandmarkScan>& landmark_scans() {
  static const std::vector<LandmarkScan> all = {
      {"seeded, bone and skin", HeadPopulation::seeded, scan_with_skin},
      {"warped, bone", HeadPopulation::warped, whole_scan},
      {"warped, to the orbits", HeadPopulation::warped, scan_below_orbits},
      {"warped, from the teeth", HeadPopulation::warped, scan_above_chin},
      {"warped, lower jaw alone", HeadPopulation::warped, scan_of_jaw}};
  return all;
}

double at_share(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

Json landmark_row(const LandmarkScan& kind, const Case& model, int heads, int threads) {
  std::vector<double> errors, doubtful, seconds, cpu_seconds;
  int outside = 0;
  for (int seed = 1; seed <= heads; ++seed) {
    const HeadSurfaces head =
        scanned_head(model, kind.population, static_cast<std::uint64_t>(seed));
    AnatomyScan scan = kind.scan(head);
    const Stopwatch watch;
    const AnatomyFit fit = fit_anatomy(scan, model, {.threads = threads});
    seconds.push_back(watch.wall_ms() / 1000);
    cpu_seconds.push_back(watch.cpu_ms() / 1000);
    for (const auto& [name, mark] : fit.landmarks) {
      (mark.doubtful ? doubtful : errors).push_back((mark.point - head.truth.at(name)).norm());
      outside += mark.outside_scan ? 1 : 0;
    }
  }
  const double median = at_share(errors, 0.5), p95 = at_share(errors, 0.95);
  return {{"name", "import.landmarks"},
          {"scan", kind.name},
          {"heads", heads},
          {"landmarks", errors.size()},
          {"median_mm", median},
          {"p95_mm", p95},
          {"worst_mm", at_share(errors, 1)},
          {"doubtful", doubtful.size()},
          {"outside", outside},
          {"worst_doubtful_mm", at_share(doubtful, 1)},
          {"median", at_share(seconds, 0.5)},
          {"unit", "s"},
          {"cpu_median", at_share(cpu_seconds, 0.5)}};
}

}  // namespace

int run_bench_landmarks(const BenchOptions& options, const CommonOptions& common) {
  const Case model = builtin_patient();
  Json json{{"machine", machine_json()}, {"results", Json::array()}};
  if (!common.quiet)
    fmt::print(stderr, "  {:<26}{:>6}{:>10}{:>8}{:>8}{:>8}{:>10}{:>8}{:>8}\n", "scan", "heads",
               "median mm", "p95", "worst", "sure", "doubtful", "s", "cpu s");
  for (const LandmarkScan& kind : landmark_scans()) {
    const Json row = landmark_row(kind, model, options.heads, common.threads);
    json["results"].push_back(row);
    if (common.quiet) continue;
    fmt::print(stderr, "  {:<26}{:>6}{:>10.2f}{:>8.2f}{:>8.2f}{:>8}{:>10}{:>8.1f}{:>8.1f}\n",
               kind.name, options.heads, row["median_mm"].get<double>(),
               row["p95_mm"].get<double>(), row["worst_mm"].get<double>(),
               row["landmarks"].get<int>(), row["doubtful"].get<int>(), row["median"].get<double>(),
               row["cpu_median"].get<double>());
  }
  if (common.json) fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  return 0;
}

}  // namespace condyle
