#include "sim/simulator/live.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "engine/core/error.h"
#include "sim/motion/measures.h"
#include "sim/simulator/leap_start.h"

namespace condyle {
namespace {

/// A time farther ahead than this is a jump of the scrub bar, not time running on.
constexpr double jump_s = 0.25;
/// Steps on the way are shown only as often as a screen wants pictures; more rarely where steps
/// take so much of the time that pictures give way to them.
constexpr std::chrono::milliseconds picture_interval(33), sparing_interval(50);
constexpr double sparing_step_s = 1.0 / 90;
constexpr double step_s = 1.0 / 60;
constexpr int step_iterations = 3;
/// After so long without a new request tissue settles, so far in each step, for so many at most.
constexpr std::chrono::milliseconds calm(60);
constexpr int settling_iterations = 30, most_settling = 20;

/// Time of the way to full opening at which the motion opens by `opening_mm`. Bisection.
double time_of_opening(const Case& patient, const Motion& motion, double opening_mm) {
  constexpr int samples = 200;
  double widest = 0, end = 0;
  for (int i = 0; i <= samples; ++i) {
    const double t = motion.duration_s * i / samples;
    const double opening = measure(patient, motion.wanted(t)).opening_mm;
    if (opening > widest) {
      widest = opening;
      end = t;
    }
    if (opening >= opening_mm) break;
  }
  double low = 0, high = end;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (measure(patient, motion.wanted(middle)).opening_mm < opening_mm ? low : high) = middle;
  }
  return high;
}

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
      held_(1 + free_parts(scene.patient.parts).size()),
      thread_([this] { work(); }) {}

LiveSimulation::~LiveSimulation() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void LiveSimulation::request(const LiveRequest& asked) {
  LiveRequest wanted = asked;
  wanted.time_s = std::round(asked.time_s / settings_.step_s) * settings_.step_s;
  {
    const std::lock_guard lock(mutex_);
    if (wanted == wanted_) return;
    wanted_ = wanted;
  }
  changed_.notify_all();
}

std::size_t LiveSimulation::body_of_part(std::size_t part) const {
  const auto& parts = scene_.patient.parts;
  const Body body = part < parts.size() ? body_of(parts[part].role) : Body::cranium;
  if (body == Body::mandible) return 0;
  if (body != Body::free)
    throw InputError((part < parts.size() ? parts[part].name : std::string("this part")) +
                     ": only the mandible, segments and transplants can be moved");
  const auto free = free_parts(parts);
  return 1 + static_cast<std::size_t>(std::find(free.begin(), free.end(), part) - free.begin());
}

void LiveSimulation::drag(std::size_t part, const Pose& wanted) {
  const std::size_t body = body_of_part(part);
  if (!wanted.R.coeffs().allFinite() || !wanted.t.allFinite() || !(wanted.R.norm() > 0.5))
    throw InputError(scene_.patient.parts[part].name +
                     ": cannot be moved to a pose with values that are no numbers");
  {
    const std::lock_guard lock(mutex_);
    held_[body] = Pose{wanted.R.normalized(), wanted.t};
    ++grips_;
  }
  changed_.notify_all();
}

void LiveSimulation::release(std::size_t part) {
  const std::size_t body = body_of_part(part);
  {
    const std::lock_guard lock(mutex_);
    held_[body].reset();
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

StepInput LiveSimulation::input(const LiveRequest& wanted, double time_s) const {
  const Motion& way = wanted.opening_mm && opening_ ? *opening_ : motion_;
  const double t =
      wanted.opening_mm ? time_of_opening(scene_.patient, way, *wanted.opening_mm) : time_s;
  return {.time_s = time_s, .X_CM_wanted = way.wanted(t), .obey_contact = wanted.obey_contact};
}

void LiveSimulation::work() {
  using Clock = std::chrono::steady_clock;
  FrameState now = rest_frame(scene_);
  LiveRequest answered;
  bool caught_up = false;  // with it
  long answered_grips = 0;
  int settling = 0;  // steps of it that are left
  const auto free = free_parts(scene_.patient.parts);
  std::vector<Pose> X_BF(free.size());  // where free parts are to be in their carriers' frames
  const auto carrier = [&](std::size_t f) {
    return scene_.patient.parts[free[f]].carrier == Body::mandible ? now.X_CM : Pose{};
  };
  LeapStart leap_start(scene_, settings_.threads);
  const auto begin_at = [&](const BodyPoses& at) {
    // No way leads there on which tissue could follow.
    if (scene_.tissue && leaps(now.X_CM, at.X_CM)) now.tissue = rest_tissue(*scene_.tissue);
    now.X_CM = at.X_CM;
    now.X_CF = at.X_CF;
    now.contacts = scene_.contacts.find(at, nullptr, settings_.threads);
  };
  auto last_shown = Clock::now();
  try {
    while (true) {
      LiveRequest wanted;
      std::vector<std::optional<Pose>> held;
      long grips = 0;
      {
        std::unique_lock lock(mutex_);
        const auto is_asked = [&] {
          return stop_ || !caught_up || answered != wanted_ || answered_grips != grips_;
        };
        if (settling == 0)
          changed_.wait(lock, is_asked);
        else if (changed_.wait_for(lock, settling == most_settling ? calm : calm.zero(), is_asked))
          settling = 0;
        if (stop_) return;
        wanted = wanted_;
        held = held_;
        grips = grips_;
      }
      const double ahead_s = wanted.time_s - now.time_s;
      const bool runs_on =
          !wanted.opening_mm && ahead_s > 1.5 * settings_.step_s && ahead_s < jump_s;
      const double time_s = runs_on ? now.time_s + settings_.step_s : wanted.time_s;
      const auto start = Clock::now();
      const auto interval = step_seconds_ > sparing_step_s ? sparing_interval : picture_interval;
      const bool shown = !runs_on || start - last_shown >= interval;
      StageTimes motion_time;
      StepInput step_input;
      {
        const StageTimer timer(motion_time, Stage::motion);
        step_input = input(wanted, time_s);
        step_input.bound_far = !shown;
        if (held[0]) step_input.X_CM_wanted = *held[0];
        for (std::size_t f = 0; f < free.size(); ++f)
          if (held[1 + f]) X_BF[f] = *held[1 + f];
        step_input.X_BF_wanted = X_BF;
      }
      const LeapStart::Asked asked{wanted, held[0], step_input.X_CM_wanted, X_BF};
      if (const auto at = leap_start.of(asked, now, grips != answered_grips)) begin_at(*at);
      // Soft tissue that nobody sees waits; it follows from where it was left.
      SimulatorSettings seen = settings_;
      seen.tissue = seen.tissue && wanted.face;
      int& iterations = seen.tissue_budget.max_iterations;
      const bool settles = settling > 0;
      if (settles) iterations = std::max(iterations, settling_iterations);
      // A mandible that is wanted so far away is no step of a motion: its tissue gets what it
      // needs.
      if (now.tissue.kept || leaps(now.tissue.X_CM, step_input.X_CM_wanted))
        iterations = TissueBudget{}.max_iterations;
      now = step(scene_, now, step_input, seen);
      for (std::size_t f = 0; f < free.size(); ++f)
        if (held[1 + f]) X_BF[f] = carrier(f).inverse() * now.X_CF[f];
      now.times[Stage::motion] = motion_time[Stage::motion];
      const bool settled = !seen.tissue || now.tissue.converged || (settles && now.tissue.kept);
      settling = settled ? 0 : settles ? settling - 1 : most_settling;
      caught_up = !runs_on;
      if (caught_up) {
        answered = wanted;
        answered_grips = grips;
        leap_start.ended(asked, now);
      }
      if (shown && wanted.face) carry_face(scene_, now, settings_.threads);
      if (shown) last_shown = start;
      const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
      const std::lock_guard lock(mutex_);
      if (shown) newest_ = now;
      if (!settles)
        step_seconds_ = step_seconds_ > 0 ? 0.9 * step_seconds_ + 0.1 * seconds : seconds;
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
}

}  // namespace condyle
