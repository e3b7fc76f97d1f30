#include "render/session/saving_session.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <ctime>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "render/session/saved/session_file.h"
#include "sim/session/patient_files.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds autosave_interval{2};
constexpr std::size_t largest_named_session = std::size_t{1} << 20;  // bytes

std::string local_time_of(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return "an unknown time";
  std::tm local{};
  localtime_r(&status.st_mtim.tv_sec, &local);
  char words[64] = "";
  std::strftime(words, sizeof words, "%Y-%m-%d %H:%M:%S", &local);
  return words;
}

/// Name of the patient of a session; empty where it is large or cannot be read.
std::string patient_in(const fs::path& file) {
  try {
    return parse_session(file, read_file(file, largest_named_session)).geometry.name;
  } catch (const std::exception&) {
    return {};  // opening it reports why
  }
}

fs::path with_session_ending(fs::path file) {
  if (file.extension() != session_ending) file += session_ending;
  return file;
}

}  // namespace

bool SavingSession::begin() {
  if (!state_.settings.keeps_files) return false;
  folder_.emplace(session_ending);
  orphans_ = folder_->take_orphans();
  return ask();
}

bool SavingSession::ask() {
  if (orphans_.empty()) return false;
  const fs::path& file = orphans_.front();
  const std::string name = patient_in(file);
  std::string words =
      fmt::format("The session{} was autosaved at {}, and its window ended without being closed.",
                  name.empty() ? "" : " of " + name, local_time_of(file));
  if (orphans_.size() > 1)
    words += fmt::format(" {} older {} kept.", orphans_.size() - 1,
                         orphans_.size() == 2 ? "one is" : "ones are");
  words += " Esc keeps it for the next start.";
  const auto answer = [&](request::Recover::Answer which) { return request::Recover{which, file}; };
  using Answer = request::Recover::Answer;
  state_.front_end.ask({.title = "A session can be recovered",
                        .words = std::move(words),
                        .answers = {{"recover-open", "Open it", answer(Answer::open)},
                                    {"recover-discard", "Discard it", answer(Answer::discard)}},
                        .unanswered = answer(Answer::later)});
  return true;
}

bool SavingSession::recover(const request::Recover& answer) {
  if (answer.answer == request::Recover::Answer::open) recovering_ = answer.file;
  if (answer.answer == request::Recover::Answer::discard) {
    folder_->discard(answer.file);
    std::erase(orphans_, answer.file);
    return ask();
  }
  orphans_.clear();  // the others are offered at the next start
  return false;
}

void SavingSession::patient_shown(const OpenedSession* opened, bool is_first) {
  autosaved_.reset();
  due_ = !is_first;
  state_.session.clear();
  if (!opened) return;
  state_.session = opened->file;
  if (opened->file != recovering_) return;
  state_.session = opened->saved.saved_as;
  due_ = true;
  recovering_.clear();
  if (opened->notes.empty())
    folder_->adopt(opened->file);
  else
    state_.front_end.report_error(
        "The session was recovered in part",
        "All of it is kept as " + folder_->set_aside(opened->file).string() + ".");
}

SavedSession SavingSession::now() const {
  ViewState view = state_.front_end.view();
  if (const auto& hands = plan_.hands_before_preview()) view.hands = *hands;
  SavedSession session = saved_view(view, state_.scene, state_.front_end.camera());
  session.source = state_.source;
  session.geometry = state_.geometry;
  const CaseGeometry own{state_.geometry.name, state_.geometry.parts, state_.source_landmarks};
  session.landmarks_replaced = !(own == state_.geometry);
  if (const PlanDocument* document = plan_.document()) {
    const Plan& plan = document->plan();
    if (!document->file().empty())
      session.plan = fs::absolute(document->file());
    else if (!plan.steps.empty() || !plan.zones.empty())
      session.draft = plan;
  }
  return session;
}

void SavingSession::save(const request::SaveSession& request) {
  if (!state_.patient) return;
  if (saving_.active())
    return state_.front_end.say("The session is being saved; ask again when that is done");
  const fs::path file = fs::absolute(with_session_ending(request.file)).lexically_normal();
  const bool agreed = request.replace && file == fs::absolute(request.file).lexically_normal();
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) throw InputError(file, "", "is a folder: add a name");
  if (fs::exists(file, ignored) && file != state_.session && !agreed)
    return state_.front_end.ask(
        {.title = "The file exists",
         .words = file.string() + " has another session or an earlier state of this one.",
         .answers = {{"session-keep", "Keep the file", {}},
                     {"session-replace", "Replace it", request::SaveSession{file, true}}}});
  saving_.start([session = now(), file](const Progress&) {
    if (file.has_parent_path()) make_folder(file.parent_path());
    write_file(file, session_json(session, file));
    return file;
  });
}

void SavingSession::autosave() {
  if (!folder_ || autosaving_.active() || Clock::now() - looked_ < autosave_interval) return;
  looked_ = Clock::now();
  auto session = std::make_shared<SavedSession>(now());
  session->saved_as = state_.session;
  const bool begins = !autosaved_ && !due_;
  if (autosaved_ && !due_ && same_session(*autosaved_, *session)) return;
  autosaved_ = session;
  due_ = false;
  if (begins) return;  // as it was opened: there is nothing to lose
  if (folder_->file().empty()) {
    if (!std::exchange(complained_, true))
      state_.front_end.say("Sessions are not autosaved: " + folder_->trouble());
    return;
  }
  autosaving_.start([session, file = folder_->file()](const Progress&) {
    write_file(file, session_json(*session, file));
    return true;
  });
}

std::optional<fs::path> SavingSession::update() {
  if (autosaving_.done()) {
    try {
      autosaving_.take();
      complained_ = false;
    } catch (const std::exception& error) {
      due_ = true;
      if (!std::exchange(complained_, true))
        state_.front_end.say(std::string("The session could not be autosaved: ") + error.what());
    }
  }
  std::optional<fs::path> saved;
  if (saving_.done())
    state_.try_or_report("Cannot save the session", [&] { saved = saving_.take(); });
  if (state_.patient && state_.motion) autosave();
  return saved;
}

void SavingSession::end() {
  try {
    if (autosaving_.active()) autosaving_.finish();
    if (saving_.active()) saving_.finish();
  } catch (const std::exception&) {  // the front end is closed
  }
  if (folder_) folder_->end();
}

}  // namespace condyle
