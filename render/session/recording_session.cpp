#include "render/session/recording_session.h"

#include <fmt/format.h>

#include <utility>

#include "render/session/window_words.h"

namespace condyle {

void RecordingSession::record(const request::Record& request,
                              std::shared_ptr<const LineSet> paths) {
  if (job_.active() || !state_.motion) return;
  const ViewState& view = state_.front_end.view();
  std::optional<Pose> held_jaw = view.hands.X_CM_target();
  if (!held_jaw && view.opening_mm && state_.newest) {
    const Case& patient = state_.patient->scene.patient;
    held_jaw = placed(patient.bodies, state_.newest->X_PB_target)[patient.jaw.lower_arch];
  }
  start(std::make_shared<ViewRecording>(ViewRecording{.record = request,
                                                      .view = view,
                                                      .bodies = state_.scene.bodies,
                                                      .held_jaw = held_jaw,
                                                      .patient = state_.patient,
                                                      .motion = state_.motion,
                                                      .paths = std::move(paths)}),
        Existing::ask);
}

void RecordingSession::start(std::shared_ptr<const ViewRecording> subject, Existing existing) {
  if (job_.active() || !subject) return;
  recorded_ = subject;
  job_.start([subject = std::move(subject), existing,
              settings = state_.settings.simulator](const Progress& progress) {
    return record_view(*subject, existing, settings, progress);
  });
}

void RecordingSession::quit(const request::Quit& request) {
  if (job_.active() && request.when_recorded) {
    quit_when_recorded_ = true;
    return;
  }
  quits_ = true;
  state_.front_end.close();
}

void RecordingSession::forget() {
  if (unfinished_) state_.retired.add(std::move(unfinished_), state_.patient);
  if (!job_.active() && recorded_) state_.retired.add(std::move(recorded_), state_.patient);
  state_.front_end.show_unfinished("");
}

bool RecordingSession::may_close() {
  if (!job_.active() || quits_) return true;
  state_.front_end.keep_open();
  state_.front_end.ask(
      {.title = "A recording is running",
       .words =
           fmt::format("Now: {}. Its pictures in {} are kept: once stopped, it can be resumed by "
                       "recording the same into the same folder.",
                       job_.progress().first, recorded_->record.folder.string()),
       .answers = {{"question:keep", "Keep recording"},
                   {"question:when-done", "Quit when done", request::Quit{true}},
                   {"question:quit", "Stop and quit", request::Quit{}}}});
  return false;
}

/// Its folder holds pictures already.
void RecordingSession::ask_about(const ViewRecorded& found) {
  const bool same = found.there.differs.empty();
  // A stopped recording is resumed with its own settings, even if the view has changed.
  const bool goes_on =
      same || (unfinished_ && unfinished_->record.folder == recorded_->record.folder);
  if (same) unfinished_ = recorded_;
  Question question{
      .title = "The folder holds a recording", .words = found.words + ".", .answers = {}};
  if (goes_on)
    question.answers.push_back({"question:resume", "Resume that one", request::ResumeRecording{}});
  question.answers.push_back({"question:cancel", "Cancel"});
  question.answers.push_back({"question:replace", "Replace it", request::ReplaceRecording{}});
  state_.front_end.ask(std::move(question));
}

void RecordingSession::update() {
  if (job_.done()) return take();
  if (!job_.active()) return;
  const auto [what, fraction] = job_.progress();
  state_.front_end.show_recording(what.empty() ? "starting" : what, fraction);
}

void RecordingSession::take() {
  const bool quits = std::exchange(quit_when_recorded_, false);
  state_.front_end.show_recording("", 0);
  state_.try_or_report("Cannot record the motion", [&] {
    using End = ViewRecorded::End;
    const auto ended = job_.take();
    if (!ended) return state_.front_end.say("The recording was stopped before its first picture");
    if (ended->end == End::asks) return ask_about(*ended);
    const bool continues =
        ended->end != End::made && ended->there.differs.empty() && ended->there.pictures > 0;
    unfinished_ = continues ? recorded_ : nullptr;
    state_.front_end.show_unfinished(
        !continues ? ""
        : ended->end == End::stopped
            ? ended->words + "."
            : fmt::format("{} pictures of the recording that failed are in {}.",
                          ended->there.pictures, recorded_->record.folder.string()));
    if (ended->end == End::failed)
      return state_.front_end.report_error("Cannot record the motion",
                                           in_window_words(ended->words));
    state_.front_end.say(ended->end == End::stopped ? "The recording was stopped: " + ended->words
                                                    : ended->words);
    if (ended->end == End::made) recorded_.reset();
    if (quits && ended->end == End::made) state_.front_end.close();
  });
}

std::string RecordingSession::finish() {
  if (!job_.active()) return {};
  job_.cancel();
  const auto ended = job_.finish();
  if (!ended || ended->words.empty()) return {};
  if (ended->end != ViewRecorded::End::stopped) return ended->words;
  return "the recording was stopped: " + ended->words +
         "; the same recording into the same folder resumes it";
}

}  // namespace condyle
