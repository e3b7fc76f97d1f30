#include "sim/simulator/live.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "engine/core/error.h"
#include "sim/simulator/live_steps.h"

namespace condyle {
namespace {

/// Steps toward a target are shown at most at the rate of a screen, and less often where the steps
/// take most of the time.
constexpr std::chrono::milliseconds picture_interval(33), sparing_interval(50);
constexpr double sparing_step_s = 1.0 / 90;
constexpr double step_s = 1.0 / 60;
constexpr int step_iterations = 5;
/// Time without a new request after which tissue settles.
constexpr std::chrono::milliseconds calm(60);

}  // namespace

SimulatorSettings live_settings(SimulatorSettings settings) {
  settings.step_s = step_s;
  settings.tissue_budget.max_iterations = step_iterations;
  return settings;
}

LiveSimulation::LiveSimulation(const Scene& scene, Motion motion, const SimulatorSettings& settings,
                               std::optional<Motion> opening)
    : scene_(scene),
      motion_(std::move(motion)),
      opening_(std::move(opening)),
      settings_(settings),
      held_(scene.patient.bodies.bodies().size()),
      thread_([this] { work(); }) {}

LiveSimulation::~LiveSimulation() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LiveSimulation::request(const LiveRequest& request) {
  LiveRequest rounded = request;
  rounded.time_s = std::round(request.time_s / settings_.step_s) * settings_.step_s;
  {
    const std::lock_guard lock(mutex_);
    if (rounded == request_) return;
    request_ = rounded;
  }
  changed_.notify_all();
}

void LiveSimulation::require_movable(BodyId body) const {
  const BodyTree& bodies = scene_.patient.bodies;
  if (index_of(body) >= bodies.bodies().size() || body == cranium_body)
    throw InputError((body == cranium_body ? "the cranium" : std::string("this body")) +
                     ": only the mandible, segments and transplants can be moved");
}

void LiveSimulation::drag(BodyId body, const Pose& X_PB_target) {
  require_movable(body);
  if (!X_PB_target.R.coeffs().allFinite() || !X_PB_target.t.allFinite() ||
      !(X_PB_target.R.norm() > 0.5))
    throw InputError(scene_.patient.bodies[body].name +
                     ": cannot be moved to a pose with values that are no numbers");
  {
    const std::lock_guard lock(mutex_);
    held_[index_of(body)] = Pose{X_PB_target.R.normalized(), X_PB_target.t};
    ++grips_;
  }
  changed_.notify_all();
}

void LiveSimulation::release(BodyId body) {
  require_movable(body);
  {
    const std::lock_guard lock(mutex_);
    held_[index_of(body)].reset();
    ++grips_;
  }
  changed_.notify_all();
}

std::optional<FrameState> LiveSimulation::take() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::exchange(newest_, std::nullopt);
}

double LiveSimulation::steps_per_second() const {
  const std::lock_guard lock(mutex_);
  return step_seconds_ > 0 ? 1 / step_seconds_ : 0;
}

std::optional<LiveTarget> LiveSimulation::next_target(LiveSteps& steps) {
  std::unique_lock lock(mutex_);
  const auto is_due = [&] { return stop_ || steps.due(request_, grips_); };
  if (steps.settling() == 0) {
    changed_.wait(lock, is_due);
  } else {
    const bool first = steps.settling() == LiveSteps::max_settling;
    if (changed_.wait_for(lock, first ? calm : calm.zero(), is_due)) steps.stop_settling();
  }
  if (stop_) return std::nullopt;
  return LiveTarget{request_, held_, grips_};
}

void LiveSimulation::publish(const FrameState* shown, bool settled_only, double seconds) {
  const std::lock_guard lock(mutex_);
  if (shown) newest_ = *shown;
  if (!settled_only)
    step_seconds_ = step_seconds_ > 0 ? 0.9 * step_seconds_ + 0.1 * seconds : seconds;
}

void LiveSimulation::work() {
  using Clock = std::chrono::steady_clock;
  try {
    LiveSteps steps(scene_, motion_, opening_ ? *opening_ : motion_, settings_);
    auto last_shown = Clock::now();
    while (const auto target = next_target(steps)) {
      const auto start = Clock::now();
      const auto interval = step_seconds_ > sparing_step_s ? sparing_interval : picture_interval;
      const bool shown = !steps.runs_on(target->request) || start - last_shown >= interval;
      const bool settles = steps.settling() > 0;
      steps.step(*target, shown);
      if (shown) last_shown = start;
      publish(shown ? &steps.frame() : nullptr, settles,
              std::chrono::duration<double>(Clock::now() - start).count());
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
}

}  // namespace condyle
