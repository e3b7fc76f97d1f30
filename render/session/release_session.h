#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "render/session/session_state.h"
#include "sim/dynamics/release_jaw.h"

namespace condyle {

/// Releases a body that a hand holds to the dynamics: a segment or transplant comes to rest on
/// bone, a jaw moves as its muscles and joints let it. What the person moves meanwhile ends it.
class ReleaseSession {
 public:
  explicit ReleaseSession(SessionState& state)
      : state_(state), job_(state.retired, state.waker()) {}

  /// `body`: number among the scene's.
  void release(std::size_t body);
  /// Once a turn: takes the result that is ready, and moves a jaw along its course.
  void update();
  /// Ends the work on what is released, and says why.
  void drop(std::string_view why);
  /// Ends the course of a jaw; a jaw that nobody has taken stays where it is by now.
  void hold();
  /// Ends the course of a jaw that belongs to a patient who is gone.
  void end();
  /// Where a released jaw is by now; none: no jaw is in motion.
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
  /// A jaw in motion, as time runs.
  struct Falling {
    Result of;
    std::vector<double> shown_s;  // of each of its poses
    std::chrono::steady_clock::time_point start;
    Pose X_CM;  // by now
  };

  void release_part(std::size_t body);
  void release_jaw(std::size_t body);
  void take();
  void start_course(Result result);
  void follow_course();
  Subject subject_now(const MovableBody& body) const;
  /// What the person has moved of the patient since the release, as words; empty for nothing.
  std::string overtaken_by() const;

  SessionState& state_;
  Subject subject_;
  std::optional<Falling> falling_;
  Job<Result> job_;
};

}  // namespace condyle
