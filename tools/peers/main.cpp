// condyle-peers [table1|table2]: other minimisers on the same energy, start and target, as JSON.
#include <fmt/format.h>
#include <glog/logging.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "engine/tissue/refactorization.h"
#include "tools/bench/baseline/baseline_minimizers.h"
#include "tools/peers/peers.h"

namespace condyle::peers {

double FlatEnergy::operator()(const double* x, double* gradient) {
  std::memcpy(x_.front().data(), x, size() * sizeof(double));
  if (!gradient) return energy_.value(x_);
  const double value = energy_.value_and_gradient(x_, gradient_);
  std::memcpy(gradient, gradient_.front().data(), size() * sizeof(double));
  return value;
}

namespace {

using Json = nlohmann::ordered_json;

/// All of them from the target's start.
void race_all(const TissueTarget& target, const char* start, int repeats, Json& results) {
  const auto add = [&](const char* name, const char* method,
                       const std::function<double(double, Nodes&)>& attempt) {
    const Race result = race(target, repeats, attempt);
    results.push_back({{"name", name},
                       {"median", result.met ? Json(result.median_ms) : Json()},
                       {"p95", result.p95_ms},
                       {"unit", "ms"},
                       {"cpu_median", result.cpu_ms},
                       {"nodes", target.set.mesh.node_count},
                       {"threads", 1},
                       {"method", method},
                       {"start", start},
                       {"met_target", result.met},
                       {"tolerance", result.tolerance},
                       {"error_mm", result.error_mm},
                       {"energy_error", result.energy_error}});
    fmt::print(stderr,
               "  {:<16}{:<20}{:>10.2f} ms wall {:>10.2f} ms processor, error {:.1e} mm{}\n", start,
               method, result.median_ms, result.cpu_ms, result.error_mm,
               result.met ? "" : " (target not met)");
  };
  const auto with = [&](auto solver) {
    return [&target, solver](double tolerance, Nodes& x) { return solver(target, tolerance, x); };
  };
  SpringPrismEnergy energy(target.set.mesh, target.loads, 1, target.batches);
  const HessianFactor factor(target.set.mesh, target.rest_loads, target.set.sheets,
                             target.set.rest);
  if (target.begun.empty())
    add("tissue.cold", "condyle", [&](double tolerance, Nodes& x) {
      MinimizeSettings settings;
      settings.tolerance_mm = tolerance;
      settings.max_step_mm = bench_step_mm;
      return minimize_with_refactorization(target.set.mesh, target.loads, energy, factor, settings,
                                           x)
          .energy;
    });
  add("tissue.cold", "cg_parabolic", [&](double tolerance, Nodes& x) {
    MinimizeSettings settings;
    settings.tolerance_mm = tolerance;
    settings.max_iterations = 20000;
    return minimize_with(Method::cg_parabolic, energy, settings, x).energy;
  });
  add("tissue.peer", "ceres_lbfgs", with(ceres_lbfgs));
  add("tissue.peer", "nlopt_lbfgs", with(nlopt_lbfgs));
  add("tissue.peer", "gsl_conjugate_pr", with(gsl_conjugate_pr));
  add("tissue.peer", "gsl_vector_bfgs2", with(gsl_bfgs2));
  add("tissue.peer", "ceres_nonlinear_cg", with(ceres_nonlinear_cg));
}

int run(const std::string& which) {
  const bool small = which == "table1";
  SyntheticSet set = make_synthetic_set(small ? table1_size() : patient2_size());
  TissueTarget target = make_target(std::move(set), bench_movement());
  Json json;
  json["machine"] = machine_json();
  fmt::print(stderr, "{} positions, cold, one thread; target {} mm and {} of the energy\n",
             target.set.mesh.node_count, target_mm, target_energy);
  race_all(target, "rest", small ? 15 : 3, json["results"]);
  if (!small) {
    const HessianFactor factor(target.set.mesh, target.rest_loads, target.set.sheets,
                               target.set.rest);
    target.begun = StoredOpening(target, factor, 1).start(target, bench_movement());
    race_all(target, "stored opening", 3, json["results"]);
  }
  fmt::print("{}\n", json.dump(2));
  return 0;
}

}  // namespace
}  // namespace condyle::peers

int main(int argc, char** argv) {
  const std::string which = argc > 1 ? argv[1] : "table2";
  if (which != "table1" && which != "table2") {
    std::fprintf(stderr, "condyle-peers: the set must be table1 or table2, not %s\n", argv[1]);
    return 2;
  }
  FLAGS_minloglevel = google::GLOG_ERROR;  // Ceres would log each restart
  try {
    return condyle::peers::run(which);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "condyle-peers: %s\n", error.what());
    return 1;
  }
}
