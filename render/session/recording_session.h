#pragma once

#include <memory>
#include <string>

#include "render/session/session_state.h"
#include "render/session/view_recording.h"

namespace condyle {

/// The recording that is made beside a session, and what becomes of one that is not complete.
class RecordingSession {
 public:
  explicit RecordingSession(SessionState& state)
      : state_(state), job_(state.retired, state.waker()) {}

  /// Records the motion as the view shows it. `paths`: of the motion, as far as they are known.
  void record(const request::Record& request, std::shared_ptr<const LineSet> paths);
  void stop() { job_.cancel(); }
  /// Continues the recording that was stopped or asked about.
  void resume() { start(unfinished_, Existing::resume); }
  /// Replaces what is in the folder of the recording that was asked about.
  void replace() { start(recorded_, Existing::replace); }
  /// Closes the front end, now or when the recording is made.
  void quit(const request::Quit& request);
  /// Whether the front end may close; asks the person while a recording is made.
  bool may_close();
  /// Once a turn: shows progress and takes the result that is ready.
  void update();
  /// Another patient is loaded: a stopped recording cannot continue.
  void forget();
  bool active() const { return job_.active(); }
  /// Ends it, waiting. gives: what there is of it, as a sentence; empty when there was none.
  std::string finish();

 private:
  void start(std::shared_ptr<const ViewRecording> subject, Existing existing);
  void take();
  void ask_about(const ViewRecorded& found);

  SessionState& state_;
  // The recording that is made or was asked about, and one that can continue.
  std::shared_ptr<const ViewRecording> recorded_, unfinished_;
  bool quit_when_recorded_ = false, quits_ = false;
  Job<ViewRecorded> job_;
};

}  // namespace condyle
