#include "render/session/release_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sim/session/release.h"

namespace condyle {
namespace {

/// Display time of each pose of the path, s: the sudden pull of the joints is slowed down so that
/// the eye can follow.
std::vector<double> times_shown(const JawRelease& course, const Eigen::Vector3d& center) {
  constexpr double fastest_mm_s = 250, arm_mm = 80;
  std::vector<double> shown_s = {0};
  for (std::size_t k = 1; k < course.X_CM.size(); ++k) {
    const Pose step = course.X_CM[k - 1].inverse() * course.X_CM[k];
    const double mm = (step * center - center).norm() + arm_mm * rotation_angle(step);
    shown_s.push_back(shown_s.back() + std::max(course.step_s, mm / fastest_mm_s));
  }
  return shown_s;
}

}  // namespace

ReleaseSession::Subject ReleaseSession::subject_now(const MovableBody& body) const {
  const ViewState& view = state_.front_end.view();
  return {body, state_.name_of(body), view.hands, view.motion, view.opening_mm, view.time_s, {}};
}

void ReleaseSession::release(std::size_t body) {
  if (job_.active() || !state_.newest || body >= state_.scene.bodies.size()) return;
  hold();
  if (state_.scene.bodies[body].roams())
    release_part(body);
  else if (state_.motion)
    release_jaw(body);
}

void ReleaseSession::release_part(std::size_t number) {
  const MovableBody& body = state_.scene.bodies[number];
  // Everything else is paused until it is at rest.
  state_.front_end.change([&](ViewState& view) {
    if (std::exchange(view.playing, false)) view.time_s = state_.newest->time_s;
  });
  subject_ = subject_now(body);
  job_.start([patient = state_.patient, body, name = subject_.name, number, frame = *state_.newest,
              threads = state_.threads()](const Progress& progress) {
    ReleasedBody released = release_body(*patient, body.body, name, frame, threads, progress);
    return Result{number, released.X_PB, std::move(released.words), {}};
  });
}

/// The jaw is held at its present pose and moves from there.
void ReleaseSession::release_jaw(std::size_t number) {
  const MovableBody& body = state_.scene.bodies[number];
  const BodyPoses from = state_.newest->poses;
  const Pose X_CM = from[state_.patient->scene.patient.jaw.lower_arch];
  const double time_s = state_.front_end.view().time_s;
  const Hands before = state_.front_end.view().hands;
  state_.front_end.change(
      [&](ViewState& view) {
        view.move(body, body.is_skull() ? view.hands.X_RC(X_CM) : X_CM, X_CM);
      },
      true);
  subject_ = subject_now(body);
  subject_.before = before;
  job_.start([patient = state_.patient, motion = state_.motion, number, time_s, from,
              settings = state_.settings](const Progress& progress) {
    ReleasedJaw jaw = condyle::release_jaw(*patient, *motion, time_s, from, settings, progress);
    return Result{number, {}, std::move(jaw.words), std::move(jaw.course)};
  });
}

std::string ReleaseSession::overtaken_by() const {
  const ViewState& view = state_.front_end.view();
  if (view.motion.spec != subject_.motion.spec) return "another motion was chosen";
  if (!(view.motion == subject_.motion)) return "the motion was changed";
  if (view.playing) return "the motion was played";
  if (view.time_s != subject_.time_s) return "the motion was moved to another time";
  if (view.opening_mm != subject_.opening_mm) return "the mouth was opened or closed";
  if (!same(view.hands.of(subject_.body), subject_.hands.of(subject_.body))) return "it was moved";
  if (!view.hands.same_jaws(subject_.hands)) return "the jaw was moved";
  return view.hands == subject_.hands ? "" : "another part was moved";
}

void ReleaseSession::drop(std::string_view why) {
  if (!job_.active()) return;
  job_.drop();
  state_.front_end.say(fmt::format("The {} is not released: {}", subject_.name, why));
}

void ReleaseSession::update() {
  // An edit made meanwhile takes precedence: the result belongs to the state before it.
  if (const std::string why = job_.active() ? overtaken_by() : ""; !why.empty())
    drop(why + " before it had come to rest");
  if (job_.done()) take();
  if (falling_) follow_course();
}

void ReleaseSession::take() {
  state_.try_or_report("Cannot release the " + subject_.name, [&] {
    std::optional<Result> result;
    try {
      result = job_.take();
    } catch (...) {
      if (subject_.before)
        state_.front_end.change([&](ViewState& view) { view.hands = *subject_.before; });
      throw;
    }
    if (!result) return;
    const MovableBody& body = state_.scene.bodies.at(result->body);
    if (!body.roams()) return start_course(std::move(*result));
    state_.front_end.change(
        [&](ViewState& view) {
          view.move(body, result->X_PB, state_.newest->poses[view.hands.jaw]);
        },
        true);
    state_.front_end.say(result->words);
  });
}

void ReleaseSession::start_course(Result result) {
  const MovableBody& body = state_.scene.bodies.at(result.body);
  const JawRelease& course = result.course;
  // The target is the pose at rest, so that edits made meanwhile contain no intermediate pose.
  const Pose start = course.X_CM.front(), end = course.X_CM.back();
  state_.front_end.change([&](ViewState& view) {
    view.hands.move(body, body.is_skull() ? *view.hands.X_RM * end.inverse() : end, end);
    view.falling = true;
  });
  subject_.hands = state_.front_end.view().hands;
  std::vector<double> shown_s = times_shown(course, body.center);
  falling_ = Falling{.of = std::move(result),
                     .shown_s = std::move(shown_s),
                     .start = std::chrono::steady_clock::now(),
                     .X_CM = start};
}

/// Moves the jaw to its present pose; any other motion of the patient ends the release.
void ReleaseSession::follow_course() {
  if (const std::string why = overtaken_by(); !why.empty()) {
    hold();
    return state_.front_end.say(
        fmt::format("The {} moves no further by itself: {}", subject_.name, why));
  }
  const double now_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - falling_->start).count();
  const auto& times = falling_->shown_s;
  const auto after = std::upper_bound(times.begin(), times.end(), now_s);
  if (after == times.end()) {
    state_.front_end.say(falling_->of.words);
    return end();
  }
  falling_->X_CM = falling_->of.course.X_CM[static_cast<std::size_t>(after - times.begin()) - 1];
}

void ReleaseSession::hold() {
  const ViewState& now = state_.front_end.view();
  if (falling_ && now.hands.same_jaws(subject_.hands) && now.opening_mm == subject_.opening_mm)
    state_.front_end.change([&](ViewState& view) {
      const Pose& X_CM = falling_->X_CM;
      const MovableBody& body = subject_.body;
      view.hands.move(body, body.is_skull() ? *view.hands.X_RM * X_CM.inverse() : X_CM, X_CM);
    });
  end();
}

void ReleaseSession::end() {
  if (falling_) state_.front_end.change([](ViewState& view) { view.falling = false; });
  falling_.reset();
}

std::optional<Pose> ReleaseSession::X_CM() const {
  return falling_ ? std::optional(falling_->X_CM) : std::nullopt;
}

}  // namespace condyle
