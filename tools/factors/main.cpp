// condyle-factors [NODES...]: the engine's Cholesky factor compared with CHOLMOD's and Eigen's, on
// one matrix of one tissue, as JSON. A separate program because parts of CHOLMOD are under the GPL;
// condyle contains nothing of it.
#include <fmt/format.h>

#include <cstdlib>
#include <exception>

#include "engine/core/error.h"
#include "engine/tissue/refactorization.h"
#include "tools/bench/baseline/hessian_system.h"
#include "tools/bench/baseline/tissue_target.h"
#include "tools/factors/solvers.h"

namespace condyle::factors {
namespace {

using Json = nlohmann::ordered_json;
using Vector = Eigen::VectorXd;

constexpr int repeats = 5;
constexpr double equal_residual = 1e-8;  // relative; "equal answers" of a linear solve
constexpr double frame_rad = 0.5 * 0.0174532925;

/// A frame of an opening mouth: the matrix is that of the frame before, the right-hand side the
/// gradient at its start.
struct Problem {
  SyntheticSet set;
  MeshLoads before = {}, loads = {};
  Nodes at = {}, start = {};  // where the matrix is taken; where the frame starts
  Nodes gradient = {};        // at the start
  Nodes answer = {};          // the frame's minimum
};

Pose pose_of_frame(int frame) {
  return synthetic_pose(0.0873 + frame * frame_rad, Eigen::Vector3d::Zero());
}

Nodes minimum(const SyntheticSet& set, const MeshLoads& loads, Nodes x) {
  const HessianFactor factor(set.mesh, loads, set.sheets, x);
  SpringPrismEnergy energy(set.mesh, loads, 1);
  MinimizeSettings settings;
  settings.tolerance_mm = 1e-6;
  settings.max_step_mm = bench_step_mm;
  if (!minimize_with_refactorization(set.mesh, loads, energy, factor, settings, x).converged())
    throw MachineError("bench: the reference did not converge");
  return x;
}

Problem make_problem(int nodes) {
  Problem p{.set = make_synthetic_set(size_of_nodes(nodes))};
  p.before = synthetic_loads(p.set, pose_of_frame(0));
  p.loads = synthetic_loads(p.set, pose_of_frame(1));
  p.at = minimum(p.set, p.before, p.set.rest);
  p.start = carried(p.set, p.at, pose_of_frame(0), pose_of_frame(1));
  SpringPrismEnergy(p.set.mesh, p.loads, 1).value_and_gradient(p.start, p.gradient);
  p.answer = minimum(p.set, p.loads, p.start);
  return p;
}

/// The engine's factor. Its analysis includes where each spring and prism is stored.
class OwnSolver final : public DirectSolver {
 public:
  OwnSolver(const Problem& p, const HessianSystem& system, int threads)
      : problem_(p),
        system_(system),
        threads_(threads),
        factor_(system.empty_factor()),
        solver_(p.set.mesh, p.before, p.set.sheets, p.at, threads) {}

  void analyse() override { HessianPattern(problem_.set.mesh, problem_.set.sheets, problem_.at); }
  void factorize() override { system_.factorize(factor_, threads_); }
  void solve(const Points& g, Points& z) const override { solver_.solve(g, z); }
  std::size_t bytes() const override { return solver_.bytes(); }

 private:
  const Problem& problem_;
  const HessianSystem& system_;
  const int threads_;
  BlockCholesky factor_;
  HessianFactor solver_;
};

Eigen::Map<const Vector> flat(const Nodes& x) {
  return {x.front().data(), static_cast<Eigen::Index>(3 * x.size())};
}

/// Conjugate gradients, preconditioned by the solver, until the residual is as small as a double
/// precision factor leaves it. Returns the number of solves.
int solve_equally(const LowerTriangle& lower, const DirectSolver& solver, const Nodes& g,
                  Nodes& z) {
  const auto A = lower.selfadjointView<Eigen::Lower>();
  const double allowed = equal_residual * flat(g).norm();
  solver.solve(g, z);
  Vector x = flat(z), r = flat(g) - A * x, d;
  Nodes rest = g, step;
  double before = 1;
  int solves = 1;
  for (; r.norm() > allowed && solves < 200; ++solves) {
    Eigen::Map<Vector>(rest.front().data(), r.size()) = r;
    solver.solve(rest, step);
    const double now = r.dot(flat(step));
    d = solves == 1 ? Vector(flat(step)) : Vector(flat(step) + now / before * d);
    const Vector Ad = A * d;
    const double length = now / d.dot(Ad);
    x += length * d;
    r -= length * Ad;
    before = now;
  }
  Eigen::Map<Vector>(z.front().data(), x.size()) = x;
  return solves;
}

/// Wall and processor time of repetitions, ms.
struct Times {
  std::vector<double> wall = {}, cpu = {};

  template <class Work>
  void add(Work&& work) {
    const Stopwatch watch;
    work();
    wall.push_back(watch.wall_ms());
    cpu.push_back(watch.cpu_ms());
  }
};

struct Competitor {
  const char *name, *method;
  int threads;
  std::unique_ptr<DirectSolver> solver;
  Times analyse = {}, factorize = {}, solve = {}, equal = {}, minimize = {};
  int solves = 0, iterations = 0;
  double residual = 0, equal_difference = 0, error_mm = 0;
};

/// One repetition of everything by one competitor.
void run(const Problem& p, const LowerTriangle& lower, const Vector& exact, bool analyse,
         Competitor& c) {
  if (analyse) c.analyse.add([&] { c.solver->analyse(); });
  c.factorize.add([&] { c.solver->factorize(); });
  Nodes z;
  c.solve.add([&] { c.solver->solve(p.gradient, z); });
  const auto A = lower.selfadjointView<Eigen::Lower>();
  const Vector off = flat(p.gradient) - A * flat(z);
  c.residual = off.norm() / flat(p.gradient).norm();
  c.equal.add([&] { c.solves = solve_equally(lower, *c.solver, p.gradient, z); });
  c.equal_difference = (flat(z) - exact).norm() / exact.norm();

  SpringPrismEnergy energy(p.set.mesh, p.loads, c.threads);
  MinimizeSettings settings;
  settings.tolerance_mm = 1e-3;
  Nodes x = p.start;
  MinimizeResult result;
  c.minimize.add([&] { result = minimize(energy, *c.solver, settings, x); });
  if (!result.converged()) throw MachineError(std::string("bench: no minimum with ") + c.method);
  c.iterations = result.iterations;
  c.error_mm = largest_distance(x, p.answer);
}

Json row_of(const Problem& p, const Competitor& c) {
  const Quantiles factorize = quantiles(c.factorize.wall);
  Json row = {{"name", c.name},
              {"median", factorize.median},
              {"p95", factorize.p95},
              {"unit", "ms"},
              {"cpu_median", quantiles(c.factorize.cpu).median},
              {"nodes", p.set.mesh.node_count},
              {"threads", c.threads},
              {"method", c.method}};
  const std::pair<const char*, const Times*> parts[] = {{"analyse", &c.analyse},
                                                        {"solve", &c.solve},
                                                        {"equal_solve", &c.equal},
                                                        {"minimize", &c.minimize}};
  for (const auto& [part, times] : parts) {
    row[std::string(part) + "_ms"] = quantiles(times->wall).median;
    row[std::string(part) + "_cpu_ms"] = quantiles(times->cpu).median;
  }
  row.update({{"samples", c.factorize.wall.size()},
              {"relative_residual", c.residual},
              {"equal_solves", c.solves},
              {"equal_difference", c.equal_difference},
              {"iterations", c.iterations},
              {"error_mm", c.error_mm},
              {"megabytes", 1e-6 * static_cast<double>(c.solver->bytes())},
              {"blas", blas_name()}});
  return row;
}

void compare(int nodes, Json& rows) {
  const Problem p = make_problem(nodes);
  const HessianSystem system(p.set.mesh, p.before, p.set.sheets, p.at);
  const LowerTriangle& lower = system.lower();
  std::vector<Competitor> all;
  const auto add = [&](const char* name, const char* method, int threads,
                       std::unique_ptr<DirectSolver> solver) {
    all.push_back(
        {.name = name, .method = method, .threads = threads, .solver = std::move(solver)});
  };
  for (const int threads : {1, 2})
    add("factor.condyle", "multifrontal, float", threads,
        std::make_unique<OwnSolver>(p, system, threads));
  add("factor.cholmod", "supernodal, double", 1, make_cholmod(CholmodKind::supernodal, lower));
  add("factor.cholmod", "simplicial, double", 1, make_cholmod(CholmodKind::simplicial, lower));
  add("factor.eigen", "SimplicialLDLT, double", 1, make_eigen_double(lower));
  add("factor.eigen", "SimplicialLDLT, float", 1, make_eigen_float(lower));

  Vector exact;
  {
    const auto reference = make_cholmod(CholmodKind::supernodal, lower);
    reference->analyse();
    reference->factorize();
    Nodes z;
    reference->solve(p.gradient, z);
    exact = flat(z);
  }
  // In turn, so that load of the machine affects all of them; the first turn is a warm-up.
  for (int turn = 0; turn <= repeats; ++turn)
    for (auto& c : all) {
      run(p, lower, exact, turn <= 3, c);
      if (turn > 0) continue;
      c.analyse = c.factorize = c.solve = c.equal = c.minimize = {};
    }
  for (const auto& c : all) rows.push_back(row_of(p, c));
}

}  // namespace
}  // namespace condyle::factors

int main(int argc, char** argv) {
  using namespace condyle;
  try {
    std::vector<int> sizes;
    for (int i = 1; i < argc; ++i) sizes.push_back(std::atoi(argv[i]));
    if (sizes.empty()) sizes = {2000, 4000, 8000};
    nlohmann::ordered_json json{{"machine", machine_json()},
                                {"results", nlohmann::ordered_json::array()}};
    for (const int nodes : sizes) {
      if (nodes < 100 || nodes > 100000)
        throw InputError("condyle-factors", "NODES", "is from 100 to 100000");
      factors::compare(nodes, json["results"]);
    }
    fmt::print("{}\n", json.dump(2));
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "condyle-factors: {}\n", error.what());
    return 1;
  }
}
