#include <fmt/format.h>

#include "tools/view_session.h"

// Of a ViewSession: the recording that is made beside it, and what becomes of one that is not
// whole.

namespace condyle {

void ViewSession::record(std::shared_ptr<const ViewRecording> subject, Existing existing) {
  if (recording_ || !subject) return;
  recorded_ = subject;
  recording_ = beside<ViewRecorded>(
      [subject = std::move(subject), existing, settings = settings_](const Progress& progress) {
        return record_view(*subject, existing, settings, progress);
      });
}

void ViewSession::carry_out(const wish::StopRecording&) {
  if (recording_) recording_->cancel();
}

void ViewSession::carry_out(const wish::ResumeRecording&) { record(unfinished_, Existing::resume); }

void ViewSession::carry_out(const wish::ReplaceRecording&) { record(recorded_, Existing::replace); }

void ViewSession::carry_out(const wish::Quit& wanted) {
  if (recording_ && wanted.when_recorded) {
    quit_when_recorded_ = true;
    return;
  }
  quits_ = true;
  window_.close();
}

bool ViewSession::may_close() {
  if (!recording_ || quits_) return true;
  window_.keep_open();
  window_.ask({.title = "A recording is being made",
               .words = fmt::format(
                   "Now: {}. Its pictures go to {} and stay there: once stopped, it goes on when "
                   "the same is recorded into the same folder.",
                   recording_->progress().first, recorded_->wanted.folder.string()),
               .answers = {{"question:keep", "Keep recording"},
                           {"question:when-done", "Quit when done", wish::Quit{true}},
                           {"question:quit", "Stop and quit", wish::Quit{}}}});
  return false;
}

/// Its folder holds pictures already.
void ViewSession::ask_about(const ViewRecorded& found) {
  const bool same = found.there.differs.empty();
  // What was stopped there goes on as it was begun, though the view is another by now.
  const bool goes_on =
      same || (unfinished_ && unfinished_->wanted.folder == recorded_->wanted.folder);
  if (same) unfinished_ = recorded_;
  Question question{
      .title = "The folder holds a recording", .words = found.words + ".", .answers = {}};
  if (goes_on)
    question.answers.push_back({"question:resume", "Resume that one", wish::ResumeRecording{}});
  question.answers.push_back({"question:cancel", "Cancel"});
  question.answers.push_back({"question:replace", "Replace it", wish::ReplaceRecording{}});
  window_.ask(std::move(question));
}

void ViewSession::take_recording() {
  if (!recording_) return;
  if (!recording_->done()) {
    const auto [what, fraction] = recording_->progress();
    window_.show_recording(what.empty() ? "starting" : what, fraction);
    return;
  }
  const auto finished = std::move(recording_);
  const bool quits = std::exchange(quit_when_recorded_, false);
  window_.show_recording("", 0);
  guarded([&] {
    using End = ViewRecorded::End;
    const auto ended = finished->take();
    if (!ended) return window_.say("The recording was stopped before its first picture");
    if (ended->end == End::asks) return ask_about(*ended);
    const bool goes_on =
        ended->end != End::made && ended->there.differs.empty() && ended->there.pictures > 0;
    unfinished_ = goes_on ? recorded_ : nullptr;
    window_.show_unfinished(!goes_on ? ""
                            : ended->end == End::stopped
                                ? ended->words + "."
                                : fmt::format("{} pictures of the recording that failed are in {}.",
                                              ended->there.pictures,
                                              recorded_->wanted.folder.string()));
    if (ended->end == End::failed) return window_.report_error(in_window_words(ended->words));
    window_.say(ended->end == End::stopped ? "The recording was stopped: " + ended->words
                                           : ended->words);
    if (ended->end == End::made) recorded_.reset();
    if (quits && ended->end == End::made) window_.close();
  });
}

std::string ViewSession::stop_recording() {
  if (!recording_) return {};
  recording_->cancel();
  const auto ended = recording_->finish();
  recording_.reset();
  if (!ended || ended->words.empty()) return {};
  if (ended->end != ViewRecorded::End::stopped) return ended->words;
  return "the recording was stopped: " + ended->words +
         "; the same recording into the same folder goes on from there";
}

}  // namespace condyle
