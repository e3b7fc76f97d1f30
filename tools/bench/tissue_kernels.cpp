#include "tools/bench/tissue_kernels.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <functional>

#include "engine/core/error.h"
#include "tools/bench/baseline/plain_elements.h"
#include "tools/bench/baseline/tissue_target.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

/// Evaluates energy and gradient with one kernel.
struct ElementMethod {
  const char *name, *method;
  std::function<double(const AxisRows& x, const AxisRows& gradient)> evaluate;
  std::vector<double> wall = {}, cpu = {}, gradient = {};  // of one evaluation; ms
};

AxisRows axis_rows(std::vector<double>& of) {
  const std::size_t row = of.size() / 3;
  return {of.data(), of.data() + row, of.data() + 2 * row};
}

Json compare_elements(int nodes) {
  constexpr int samples = 9, evaluations = 100;
  const SyntheticSet set = make_synthetic_set(size_of_nodes(nodes));
  const ElementBatches batches(set.mesh);
  const PlainElements plain(set.mesh);
  const Nodes moved = carried(set, set.rest, Pose{}, synthetic_pose(0.02, {0, 0, 0}));
  std::vector<double> x(3 * (moved.size() + ElementBatches::lanes));
  for (std::size_t i = 0; i < moved.size(); ++i) {
    axis_rows(x).x[i] = moved[i].x();
    axis_rows(x).y[i] = moved[i].y();
    axis_rows(x).z[i] = moved[i].z();
  }
  const double scale = (1 - set.mesh.lambda) / set.mesh.lambda;
  std::vector<double> inverse_length(batches.rest_length.size());
  const auto batched = [&](const ElementKernels* kernels) {
    return [&, kernels](const AxisRows& at, const AxisRows& gradient) {
      double energy = 0;
      for (const int half : {0, 1})
        energy += kernels->springs(batches, half, set.mesh.compression_ratio, at, gradient,
                                   inverse_length.data()) +
                  scale * kernels->prisms(batches, half, set.mesh.barrier_fraction,
                                          set.mesh.barrier_weight, at, scale, gradient);
      return energy;
    };
  };
  ElementMethod methods[] = {
      {"elements.condyle", "batches, widest", batched(usable_element_kernels().front())},
      {"elements.condyle", "batches, portable", batched(usable_element_kernels().back())},
      {"elements.plain", "plain loops", [&](const AxisRows& at, const AxisRows& gradient) {
         return plain.value_and_gradient(at, scale, gradient);
       }}};
  for (int sample = -1; sample < samples; ++sample)  // the first warms up
    for (ElementMethod& m : methods) {
      const Stopwatch watch;
      for (int i = 0; i < evaluations; ++i) {
        m.gradient.assign(x.size(), 0.0);
        m.evaluate(axis_rows(x), axis_rows(m.gradient));
      }
      if (sample < 0) continue;
      m.wall.push_back(watch.wall_ms() / evaluations);
      m.cpu.push_back(watch.cpu_ms() / evaluations);
    }
  Json rows = Json::array();
  for (const ElementMethod& m : methods) {
    double difference = 0, largest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      difference = std::max(difference, std::abs(m.gradient[i] - methods[0].gradient[i]));
      largest = std::max(largest, std::abs(methods[0].gradient[i]));
    }
    const Quantiles times = quantiles(m.wall);
    rows.push_back({{"name", m.name},
                    {"median", times.median},
                    {"p95", times.p95},
                    {"unit", "ms"},
                    {"cpu_median", quantiles(m.cpu).median},
                    {"nodes", set.mesh.node_count},
                    {"threads", 1},
                    {"method", m.method},
                    {"springs", set.mesh.spring_a.size()},
                    {"prisms", set.mesh.prisms.size()},
                    {"samples", samples},
                    {"relative_difference", difference / largest}});
  }
  return rows;
}

}  // namespace

Json output_of_companion(const char* program, const char* arguments) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto path = self.parent_path() / program;
  if (error || !std::filesystem::exists(path)) return {};
  std::string output;
  // Libraries of dense products begin no threads of their own.
  const std::string command = "OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 '" + path.string() + "' " +
                              arguments + " 2>/dev/null";
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return {};
  char buffer[4096];
  while (const std::size_t count = std::fread(buffer, 1, sizeof buffer, pipe))
    output.append(buffer, count);
  if (pclose(pipe) != 0) throw MachineError(path.string() + ": failed");
  return Json::parse(output);
}

Json factor_rows() {
  const Json output = output_of_companion("condyle-factors", "");
  return output.is_null() ? Json::array() : output["results"];
}

Json element_rows(const std::vector<int>& sizes) {
  Json rows = Json::array();
  for (const int nodes : sizes)
    for (auto& row : compare_elements(nodes)) rows.push_back(std::move(row));
  return rows;
}

void print_kernel_rows(const Json& rows) {
  fmt::print(stderr,
             "Cholesky factor, processor ms; \"equal\": solve to a relative residual of 1e-8\n");
  fmt::print(stderr, "  {:<16}{:<24}{:>6}{:>8}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>12}\n",
             "", "method", "nodes", "threads", "wall", "analyse", "factorise", "solve", "equal",
             "residual", "minimise", "error mm");
  const auto number = [](const Json& row, const char* key) { return row[key].get<double>(); };
  for (const auto& row : rows)
    if (row["name"].get<std::string>().starts_with("factor"))
      fmt::print(stderr,
                 "  {:<16}{:<24}{:>6}{:>8}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.1e}"
                 "{:>10.2f}{:>12.1e}\n",
                 row["name"].get<std::string>(), row["method"].get<std::string>(),
                 row["nodes"].get<int>(), row["threads"].get<int>(), number(row, "median"),
                 number(row, "analyse_cpu_ms"), number(row, "cpu_median"),
                 number(row, "solve_cpu_ms"), number(row, "equal_solve_cpu_ms"),
                 number(row, "relative_residual"), number(row, "minimize_cpu_ms"),
                 number(row, "error_mm"));
  fmt::print(stderr, "Energy and gradient of the elements, ms\n");
  fmt::print(stderr, "  {:<18}{:<22}{:>6}{:>10}{:>12}{:>12}\n", "", "method", "nodes", "wall",
             "processor", "difference");
  for (const auto& row : rows)
    if (row["name"].get<std::string>().starts_with("elements"))
      fmt::print(stderr, "  {:<18}{:<22}{:>6}{:>10.3f}{:>12.3f}{:>12.1e}\n",
                 row["name"].get<std::string>(), row["method"].get<std::string>(),
                 row["nodes"].get<int>(), number(row, "median"), number(row, "cpu_median"),
                 number(row, "relative_difference"));
}

}  // namespace condyle
