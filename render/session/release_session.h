#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "render/session/session_state.h"
#include "sim/dynamics/release_jaw.h"

namespace condyle {

/// Releases a body that a hand holds to the dynamics: a segment or transplant comes to rest on
/// bone, a jaw moves under its muscles and joints. Moving the patient meanwhile ends the release.
class ReleaseSession {
 public:
  explicit ReleaseSession(SessionState& state)
      : state_(state), job_(state.retired, state.waker()) {}

  /// `body`: number among the scene's.
  void release(std::size_t body);
  /// Called once per turn: takes a finished result, and moves a jaw along its path.
  void update();
  /// Cancels the release and reports why.
  void drop(std::string_view why);
  /// Ends the motion of a released jaw; one that no hand holds stays at its present pose.
  void hold();
  /// Ends the motion of a released jaw, since another patient is loaded.
  void end();
  /// Present pose of a released jaw; none: no jaw is in motion.
  std::optional<Pose> X_CM() const;
  const auto& job() const { return job_; }

 private:
  struct Result {
    std::size_t body;
    Pose X_PB;  // of a body that came to rest on bone, in its parent's frame
    std::string words;
    JawRelease course;  // of a jaw
  };
  /// What was released, and the state in which it was.
  struct Subject {
    MovableBody body;
    std::string name;
    Hands hands;
    MotionChoice motion;
    std::optional<double> opening_mm;
    double time_s = 0;
    std::optional<Hands> before = {};  // targets to restore if it cannot be released
  };
  /// A released jaw in motion.
  struct Falling {
    Result of;
    std::vector<double> shown_s;  // display time of each of its poses
    std::chrono::steady_clock::time_point start;
    Pose X_CM;  // present pose
  };

  void release_part(std::size_t body);
  void release_jaw(std::size_t body);
  void take();
  void start_course(Result result);
  void follow_course();
  Subject subject_now(const MovableBody& body) const;
  /// What the user has moved since the release, as text; empty for nothing.
  std::string overtaken_by() const;

  SessionState& state_;
  Subject subject_;
  std::optional<Falling> falling_;
  Job<Result> job_;
};

}  // namespace condyle
