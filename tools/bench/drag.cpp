// A segment of the class III plan dragged in a live simulation: free, blocked, with the face.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/motion/motion.h"
#include "sim/operated/operated_scene.h"
#include "sim/simulator/live_steps.h"
#include "tools/bench/baseline/tissue_target.h"
#include "tools/bench/bench.h"
#include "tools/common.h"
#include "tools/demo/class_iii_plan.h"
#include "tools/demo/plan_steps.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

constexpr int moves = 40;
constexpr double move_mm = 0.25;
constexpr double settled_mm = 0.2;  // about a pixel of the displayed face
constexpr double free_goal_ms = 1000.0 / 60, blocked_goal_ms = 1000.0 / 20, face_goal_ms = 200;

/// A drag in equal moves, from the planned position.
struct DragRow {
  std::string name, segment, direction;
  Eigen::Vector3d along = Eigen::Vector3d::Zero();  // in the cranium's frame
  bool face = false;
  double goal_ms = 0;
};

class DragBench {
 public:
  DragBench(const Scene& scene, const SimulatorSettings& settings, const BenchOptions& options,
            const CommonOptions& common)
      : scene_(scene),
        options_(options),
        common_(common),
        settings_(live_settings(settings)),
        rest_(make_motion("rest", scene.patient, scene.contacts)) {
    if (!common_.quiet)
      fmt::print(stderr, "  {:<14}{:<10}{:<10}{:>8}{:>8}{:>8}{:>10}{:>10}{:>12}\n", "", "segment",
                 "", "ms", "p95", "goal", "contacts", "short, mm", "settled, ms");
  }

  void run(const DragRow& row) {
    std::vector<double> wall, cpu, settled;
    LiveTarget target;
    for (int repeat = 0; repeat <= options_.repeats; ++repeat) {  // the first warms up
      LiveSteps steps(scene_, rest_, rest_, settings_);
      target = begin(steps, row);
      const BodyId body = scene_.patient.bodies.find(row.segment).value();
      for (int i = 1; i <= moves; ++i) {
        target.X_PB_held[index_of(body)] = {Eigen::Quaterniond::Identity(),
                                            move_mm * i * row.along};
        ++target.grips;
        const Stopwatch watch;
        steps.step(target, true);
        if (repeat == 0) continue;
        wall.push_back(watch.wall_ms());
        cpu.push_back(watch.cpu_ms());
      }
      if (row.face && repeat > 0) settled.push_back(settling_ms(steps, target));
      contacts_ = steps.frame().contacts.contact_count();
      short_mm_ = (pose_in(scene_.patient.bodies[body].parent, body, steps.frame().poses).t -
                   target.X_PB_held[index_of(body)]->t)
                      .norm();
    }
    add(row, wall, cpu, settled);
  }

  void print_json() const {
    const Json json{{"machine", machine_json()}, {"results", results_}};
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  }

 private:
  LiveTarget begin(LiveSteps& steps, const DragRow& row) const {
    LiveTarget target;
    target.request.face = row.face;
    target.X_PB_held.resize(static_cast<std::size_t>(scene_.patient.bodies.size()));
    steps.step(target, true);
    return target;
  }

  /// Time after the last step until the displayed face stays within `settled_mm` of where it ends.
  static double settling_ms(LiveSteps& steps, const LiveTarget& target) {
    std::vector<double> ms{0};
    std::vector<std::vector<Eigen::Vector3f>> faces{steps.frame().face};
    const Stopwatch watch;
    while (steps.settling() > 0 && !steps.frame().tissue.converged) {
      steps.step(target, true);
      ms.push_back(watch.wall_ms());
      faces.push_back(steps.frame().face);
    }
    std::size_t first = faces.size() - 1;
    while (first > 0 && largest_distance(faces[first - 1], faces.back()) <= settled_mm) --first;
    return ms[first];
  }

  static double largest_distance(const std::vector<Eigen::Vector3f>& a,
                                 const std::vector<Eigen::Vector3f>& b) {
    float most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
    return most;
  }

  void add(const DragRow& row, const std::vector<double>& wall, const std::vector<double>& cpu,
           const std::vector<double>& settled) {
    const Quantiles times = quantiles(wall), settling = quantiles(settled);
    if (!common_.quiet)
      fmt::print(stderr, "  {:<14}{:<10}{:<10}{:>8.1f}{:>8.1f}{:>8.1f}{:>10}{:>10.2f}{:>12}\n",
                 row.name, row.segment, row.direction, times.median, times.p95, row.goal_ms,
                 contacts_, short_mm_,
                 row.face ? fmt::format("{:.0f}", settling.median) : std::string());
    Json json{{"name", row.name},
              {"median", times.median},
              {"p95", times.p95},
              {"unit", "ms"},
              {"cpu_median", quantiles(cpu).median},
              {"segment", row.segment},
              {"direction", row.direction},
              {"samples", wall.size()},
              {"threads", common_.threads},
              {"goal", row.goal_ms},
              {"contact_pairs", contacts_},
              {"short_mm", short_mm_}};
    if (row.face) {
      json["settled_ms"] = settling.median;
      json["settled_within_mm"] = settled_mm;
    }
    results_.push_back(std::move(json));
  }

  const Scene& scene_;
  const BenchOptions& options_;
  const CommonOptions& common_;
  SimulatorSettings settings_;
  Motion rest_;
  int contacts_ = 0;
  double short_mm_ = 0;
  Json results_ = Json::array();
};

}  // namespace

int run_bench_drag(const BenchOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const ClassIiiPlan class_iii = make_class_iii_plan(common.threads, bar.callback());
  SimulatorSettings settings;
  settings.threads = common.threads;
  // The chin hangs free below its cut; both jaws lie against the bone around them.
  Plan plan =
      with_cut(class_iii.patient, class_iii.plan, {.osteotomy = "genioplasty", .target = "distal"});
  plan = with_move(std::move(plan), "chin", {"forward", "2", "down", "2"});
  const Scene scene = make_operated_scene(class_iii.patient, plan, settings, bar.callback());
  scene.contacts.prepare_sliding(bar.callback(), common.threads);
  bar.clear();
  DragBench bench(scene, settings, options, common);
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ(), forward = -Eigen::Vector3d::UnitY();
  for (const bool face : {false, true}) {
    const auto drag = [&](bool free, const char* segment, const char* direction,
                          const Eigen::Vector3d& along) {
      bench.run({face   ? "drag.face"
                 : free ? "drag.free"
                        : "drag.blocked",
                 segment, direction, along, face,
                 face   ? face_goal_ms
                 : free ? free_goal_ms
                        : blocked_goal_ms});
    };
    drag(true, "chin", "forward", forward);
    drag(false, "chin", "up", -down);
    drag(false, "distal", "down", down);
    drag(false, "maxilla", "forward", forward);
  }
  if (common.json) bench.print_json();
  return 0;
}

}  // namespace condyle
