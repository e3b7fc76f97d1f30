#include "sim/motion/movements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double default_speed_mm_s = 40;
constexpr double default_glide_mm_s = 15;  // gliding on the teeth
constexpr double shortest_s = 0.15;
constexpr double guide_step_mm = 0.4;  // of condylar travel between samples of the guide
constexpr double contact_theta = 0.3 * degree;
constexpr double clear_theta = 14 * degree;  // the teeth are clear beyond this rotation
constexpr double never = -1;                 // rad, below any closed position
constexpr double farthest_forward_mm = 17;

}  // namespace

double minimum_jerk(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10 + u * (-15 + 6 * u));
}

JawInputs Movements::Leg::resolved(double progress) const {
  JawInputs in = at(progress);
  if (closed) {
    const double least = (*closed)(progress);
    in.theta = on_teeth ? least : std::max(in.theta, least);
  }
  return in;
}

Movements::Movements(std::shared_ptr<const JawJoints> joints, std::shared_ptr<BiteGuide> guide,
                     const OpeningLimits& limits, const MotionParameters& parameters,
                     BonesFree free)
    : joints_(std::move(joints)),
      guide_(std::move(guide)),
      limits_(limits),
      parameters_(parameters),
      free_(std::move(free)) {}

/// Adds a note unless it is already there.
void Movements::add_note(const std::string& note) {
  if (std::find(notes_.begin(), notes_.end(), note) == notes_.end()) notes_.push_back(note);
}

JawInputs Movements::at_condyles(double left_mm, double right_mm) const {
  return {0, left_mm, right_mm, joints_->bennett_shift_mm(left_mm, right_mm)};
}

JawInputs Movements::biting(double left_mm, double right_mm) {
  JawInputs in = at_condyles(left_mm, right_mm);
  in.theta = guide_->theta(in);
  return in;
}

JawInputs Movements::opened(double theta) const {
  const double forward = limits_.coupling.forward_mm(theta);
  JawInputs in = at_condyles(forward, forward);
  in.theta = theta;
  return in;
}

bool Movements::in_contact() {
  return here_.theta - biting(here_.left_mm, here_.right_mm).theta < contact_theta;
}

/// Tabulates the guide along the path, so that playback needs no search.
Movements::Leg Movements::leg(Path at, bool on_teeth) {
  constexpr int coarse_samples = 64;
  Leg made{.at = std::move(at), .closed = {}, .on_teeth = on_teeth};
  double travel = 0;
  JawInputs before = made.at(0);
  bool low = on_teeth;
  for (int i = 0; i <= coarse_samples; ++i) {
    const JawInputs in = made.at(static_cast<double>(i) / coarse_samples);
    travel +=
        std::max(std::abs(in.left_mm - before.left_mm), std::abs(in.right_mm - before.right_mm));
    low |= in.theta < clear_theta;
    before = in;
  }
  if (!low) return made;
  const int samples = std::clamp(static_cast<int>(std::ceil(travel / guide_step_mm)), 4, 400);
  std::vector<double> progress, closed;
  for (int i = 0; i <= samples; ++i) {
    progress.push_back(static_cast<double>(i) / samples);
    const JawInputs in = made.at(progress.back());
    closed.push_back(on_teeth || in.theta < clear_theta ? guide_->theta(in) : never);
  }
  made.closed = Pchip(progress, closed);
  return made;
}

double Movements::path_length_mm(const Leg& made) const {
  constexpr int steps = 48;
  double length = 0;
  Vector3d before = joints_->incisor(made.resolved(0));
  for (int i = 1; i <= steps; ++i) {
    const Vector3d now = joints_->incisor(made.resolved(static_cast<double>(i) / steps));
    length += (now - before).norm();
    before = now;
  }
  return length;
}

void Movements::begin(const std::string& phase) {
  if (!phases_.empty()) phases_.back().end_s = now_s_;
  phases_.push_back({phase, now_s_, now_s_});
}

void Movements::append(Leg made, const Pace& pace) {
  const double speed = pace.speed_mm_s.value_or(
      parameters_.speed_mm_s.value_or(made.on_teeth ? default_glide_mm_s : default_speed_mm_s));
  made.start_s = now_s_;
  made.duration_s = pace.duration_s.value_or(std::max(path_length_mm(made) / speed, shortest_s));
  now_s_ += made.duration_s;
  here_ = made.resolved(1);
  legs_.push_back(std::move(made));
}

void Movements::hold(double seconds) {
  if (seconds <= 0) return;
  Leg still{.at = [in = here_](double) { return in; }, .closed = {}};
  append(std::move(still), {.duration_s = seconds, .speed_mm_s = {}});
}

void Movements::wait_until(double time_s) {
  if (time_s > now_s_ + 1e-9) hold(time_s - now_s_);
}

/// Moves through free space with rotation and translation coupled as in opening; deviations of
/// start and target from that coupling are blended. The timing follows the descent of the incisal
/// point.
void Movements::swing(const JawInputs& target, const Pace& pace) {
  const JawInputs from = here_;
  const auto by_theta = [=, joints = joints_, coupling = limits_.coupling](double theta, double w) {
    const auto forward = [&](double at) { return coupling.forward_mm(at); };
    const auto travel = [&](double start, double end) {
      return forward(theta) + (start - forward(from.theta)) * (1 - w) +
             (end - forward(target.theta)) * w;
    };
    const double left = travel(from.left_mm, target.left_mm);
    const double right = travel(from.right_mm, target.right_mm);
    return JawInputs{theta, left, right, joints->bennett_shift_mm(left, right)};
  };
  const double turn = target.theta - from.theta;
  const double opening0 = joints_->opening_mm(from), opening1 = joints_->opening_mm(target);
  const auto at = [=, joints = joints_](double progress) {
    if (progress <= 0) return from;
    if (progress >= 1) return target;
    if (std::abs(opening1 - opening0) < 2 || turn * (opening1 - opening0) <= 0)
      return by_theta(from.theta + turn * progress, progress);
    const double requested = opening0 + (opening1 - opening0) * progress;
    double low = 0, high = 1;
    for (int i = 0; i < 50; ++i) {
      const double w = 0.5 * (low + high);
      const double drop = joints->opening_mm(by_theta(from.theta + turn * w, w));
      ((drop - requested) * turn < 0 ? low : high) = w;
    }
    const double w = 0.5 * (low + high);
    return by_theta(from.theta + turn * w, w);
  };
  append(leg(at, false), pace);
}

Movements::Leg Movements::straight_glide(double left0, double right0, double left1, double right1) {
  return leg(
      [=, joints = joints_](double p) {
        const double left = left0 + (left1 - left0) * p, right = right0 + (right1 - right0) * p;
        return JawInputs{0, left, right, joints->bennett_shift_mm(left, right)};
      },
      true);
}

/// Moves the condyles to a position with the teeth in contact: along the teeth if they touch now,
/// else through free space.
void Movements::glide(double left_mm, double right_mm, const Pace& pace) {
  if (!in_contact()) {
    swing(biting(left_mm, right_mm), pace);
    return;
  }
  const JawInputs from = here_;
  append(straight_glide(from.left_mm, from.right_mm, left_mm, right_mm), pace);
}

void Movements::open_to(double opening_mm, const Pace& pace) {
  double low = joints_->closed_theta(), high = limits_.widest_theta;
  if (joints_->opening_mm(opened(high)) <= opening_mm) low = high;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (joints_->opening_mm(opened(middle)) < opening_mm ? low : high) = middle;
  }
  swing(opened(0.5 * (low + high)), pace);
}

void Movements::close(const Pace& pace) {
  if (in_contact())
    glide(0, 0, pace);
  else
    swing(biting(0, 0), pace);
}

void Movements::back(const std::string& phase, std::optional<double> duration_s) {
  begin(phase);
  swing({}, {.duration_s = duration_s, .speed_mm_s = {}});
}

/// Forward travel at which `reached_mm` takes the requested value, by safeguarded iteration.
double Movements::reach_for(double target_mm, const std::function<double(double)>& reached_mm,
                            const std::string& what, bool asked) {
  constexpr double close_mm = 0.005;
  double low = 0, high = farthest_forward_mm;
  const double most = reached_mm(high);
  if (most < target_mm) {
    const std::string problem =
        fmt::format("{} {:.1f} mm: this jaw reaches {:.1f} mm with its condyle {:.0f} mm forward",
                    what, target_mm, most, high);
    if (asked) throw InputError(problem + "; request less");
    add_note(problem);
    return high;
  }
  double middle = std::min(target_mm, high);
  for (int i = 0; i < 30; ++i) {
    const double reached = reached_mm(middle);
    if (std::abs(reached - target_mm) < close_mm) break;
    (reached < target_mm ? low : high) = middle;
    // The remainder is about the additional travel of the condyle.
    middle += target_mm - reached;
    if (middle <= low || middle >= high) middle = 0.5 * (low + high);
  }
  return middle;
}

double Movements::forward_for(double protrusion_mm, const std::string& where, bool asked) {
  const double start = joints_->incisor(biting(0, 0)).y();
  return reach_for(
      protrusion_mm, [&](double s) { return start - joints_->incisor(biting(s, s)).y(); }, where,
      asked);
}

double Movements::forward_aside_for(double aside_mm, bool to_left, const std::string& where,
                                    bool asked) {
  const double start = joints_->incisor(biting(0, 0)).x();
  return reach_for(
      aside_mm,
      [&](double s) {
        const Vector3d now = joints_->incisor(to_left ? biting(0, s) : biting(s, 0));
        return std::abs(now.x() - start);
      },
      where, asked);
}

void Movements::add(const Statement& statement) {
  const Pace pace{statement.duration_s, statement.speed_mm_s};
  const bool asked = statement.amount.has_value();
  switch (statement.verb) {
    case Verb::open: {
      begin("opening");
      const double most = joints_->opening_mm(opened(limits_.widest_theta));
      const double requested = statement.amount.value_or(most);
      if (requested > most + 1e-6)
        throw InputError(fmt::format(
            "{}: this jaw opens to {:.1f} mm; to attempt more, write \"set opening {}\" before the "
            "first movement",
            statement.where, most, requested));
      open_to(requested, pace);
      break;
    }
    case Verb::close:
      begin("closing");
      close(pace);
      break;
    case Verb::hinge: {
      begin("hinge");
      JawInputs target = here_;
      target.theta += *statement.amount * degree;
      append(leg(
                 [from = here_, target](double p) {
                   JawInputs in = from;
                   in.theta += (target.theta - from.theta) * p;
                   return in;
                 },
                 false),
             pace);
      break;
    }
    case Verb::protrude: {
      begin("protrusion");
      const double s = forward_for(statement.amount.value_or(parameters_.protrusion_mm.value_or(8)),
                                   statement.where, asked);
      glide(s, s, pace);
      break;
    }
    case Verb::retrude: {
      begin("retrusion");
      const double s = asked ? *statement.amount : retruded_mm();
      glide(-s, -s, pace);
      break;
    }
    case Verb::left:
    case Verb::right: {
      const bool to_left = statement.verb == Verb::left;
      begin(to_left ? "laterotrusion left" : "laterotrusion right");
      double s =
          forward_aside_for(statement.amount.value_or(parameters_.laterotrusion_mm.value_or(9)),
                            to_left, statement.where, asked);
      if (!asked && !parameters_.laterotrusion_mm) s = free_aside(to_left, s, false);
      glide(to_left ? 0 : s, to_left ? s : 0, pace);
      break;
    }
    case Verb::rest:
      begin("rest position");
      open_to(joints_->opening_mm(biting(0, 0)) +
                  statement.amount.value_or(parameters_.freeway_mm.value_or(2.5)),
              pace);
      break;
    case Verb::hold:
      begin("hold");
      hold(*statement.amount);
      break;
    case Verb::posselt:
      posselt(pace);
      break;
    case Verb::chew_left:
    case Verb::chew_right:
      chew(statement.verb == Verb::chew_left, statement);
      break;
    case Verb::face:
      begin("expression");
      break;
  }
}

Motion Movements::finish(const std::string& name) {
  if (!phases_.empty()) phases_.back().end_s = now_s_;
  Motion motion;
  motion.name = name;
  motion.duration_s = now_s_;
  motion.notes = notes_;
  motion.phases = phases_;
  if (traces_borders_) motion.borders = borders();
  motion.target = [legs = std::make_shared<const std::vector<Leg>>(std::move(legs_)),
                   joints = joints_](double time_s) {
    if (legs->empty()) return Pose{};
    const auto next = std::upper_bound(legs->begin(), legs->end(), time_s,
                                       [](double t, const Leg& leg) { return t < leg.start_s; });
    const Leg& leg = next == legs->begin() ? *next : *(next - 1);
    double u = std::clamp((time_s - leg.start_s) / leg.duration_s, 0.0, 1.0);
    if (leg.eased) u = minimum_jerk(u);
    const JawInputs in = leg.resolved(u);
    // Exactly the rest pose of the case.
    if (in.theta == 0 && in.left_mm == 0 && in.right_mm == 0 && in.shift_mm == 0) return Pose{};
    return joints->pose(in);
  };
  return motion;
}

}  // namespace condyle
