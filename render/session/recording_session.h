#pragma once

#include <memory>
#include <string>

#include "render/session/session_state.h"
#include "render/session/view_recording.h"

namespace condyle {

/// The background recording of a session, and the handling of an incomplete one.
class RecordingSession {
 public:
  explicit RecordingSession(SessionState& state)
      : state_(state), job_(state.retired, state.waker()) {}

  /// Records the motion as the view shows it. `paths`: of the motion, as far as known.
  void record(const request::Record& request, std::shared_ptr<const LineSet> paths);
  void stop() { job_.cancel(); }
  /// Resumes the recording that was stopped or found in the folder.
  void resume() { start(unfinished_, Existing::resume); }
  /// Replaces the recording that was found in the folder.
  void replace() { start(recorded_, Existing::replace); }
  /// Closes the front end, now or when the recording is complete.
  void quit(const request::Quit& request);
  /// Whether the front end may close; asks the user while a recording runs.
  bool may_close();
  /// Called once per turn: shows progress and takes a finished result.
  void update();
  /// Discards a stopped recording, since another patient is loaded.
  void forget();
  bool active() const { return job_.active(); }
  /// Ends the recording and waits. Returns its state as a sentence; empty if there was none.
  std::string finish();

 private:
  void start(std::shared_ptr<const ViewRecording> subject, Existing existing);
  void take();
  void ask_about(const ViewRecorded& found);

  SessionState& state_;
  // The recording in progress or in question, and one that can be resumed.
  std::shared_ptr<const ViewRecording> recorded_, unfinished_;
  bool quit_when_recorded_ = false, quits_ = false;
  Job<ViewRecorded> job_;
};

}  // namespace condyle
