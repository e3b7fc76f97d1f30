#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/session/patient_loader.h"
#include "render/session/plan_session.h"
#include "render/session/session_state.h"
#include "sim/session/autosave_folder.h"

namespace condyle {

/// Saves the state of a session in files: at the user's request, and by itself in the user's folder
/// of states, from where it is recovered after a kill. Files are written on another thread.
class SavingSession {
 public:
  SavingSession(SessionState& state, const PlanSession& plan)
      : state_(state),
        plan_(plan),
        saving_(state.retired, state.waker()),
        autosaving_(state.retired, state.waker()) {}

  /// Begins to autosave. If a session was left by a window that was killed, asks what becomes of it
  /// and returns true; the answer is a request::Recover.
  bool begin();
  /// throws: InputError for a file that exists and is no session; asks before it replaces another.
  void save(const request::SaveSession& request);
  /// The session that the user has chosen is being opened; or it was discarded, or left for the
  /// next start. Returns whether the next one is asked about.
  bool recover(const request::Recover& answer);
  /// Whether a recovered session is being opened.
  bool recovering() const { return !recovering_.empty(); }
  /// A recovered session could not be opened; it is offered at the next start.
  void recovery_failed() { recovering_.clear(); }

  /// Called when a patient is shown; `opened`: with the session that it belongs to.
  void patient_shown(const OpenedSession* opened, bool is_first);
  /// Once a turn, unless a patient is being loaded: autosaves what has changed. Returns the file
  /// that was saved at the user's request, once.
  std::optional<std::filesystem::path> update();
  /// The front end closes as the user asked: nothing is left to recover.
  void end();

 private:
  SavedSession now() const;
  void autosave();
  bool ask();

  SessionState& state_;
  const PlanSession& plan_;
  std::optional<AutosaveFolder> folder_;           // none before begin()
  std::vector<std::filesystem::path> orphans_;     // to be asked about, the newest first
  std::filesystem::path recovering_;               // that is being opened
  std::shared_ptr<const SavedSession> autosaved_;  // the last state, or the one at the start
  bool due_ = false;                               // also if nothing changes any more
  bool complained_ = false;                        // that nothing can be autosaved
  std::chrono::steady_clock::time_point looked_{};
  Job<std::filesystem::path> saving_;
  Job<bool> autosaving_;
};

}  // namespace condyle
