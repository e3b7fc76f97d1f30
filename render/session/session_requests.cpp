#include <fmt/format.h>

#include "engine/core/error.h"
#include "render/session/view_session.h"
#include "sim/case/case_io.h"
#include "sim/phantom/head_shape.h"
#include "sim/session/patient_files.h"

// One-time requests of the user to a ViewSession.

namespace condyle {
namespace fs = std::filesystem;
namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

/// Title of the dialog that reports why the request failed.
std::string title_of_failure(const Request& request) {
  return std::visit(
      Overloaded{[](const request::Open&) { return "Cannot open this"; },
                 [](const request::Import&) { return "Cannot make a patient of these surfaces"; },
                 [](const request::Record&) { return "Cannot record the motion"; },
                 [](const request::StopRecording&) { return "Cannot stop the recording"; },
                 [](const request::ResumeRecording&) { return "Cannot resume the recording"; },
                 [](const request::ReplaceRecording&) { return "Cannot replace the recording"; },
                 [](const request::Quit&) { return "Cannot quit"; },
                 [](const request::Cancel&) { return "Cannot cancel this"; },
                 [](const request::Release&) { return "Cannot release this"; },
                 [](const request::SaveCase&) { return "Cannot save the patient"; },
                 [](const request::UseLandmarks&) { return "Cannot use these landmarks"; },
                 [](const request::EditPlan&) { return "Cannot edit the plan"; },
                 [](const request::PreviewCut&) { return "Cannot preview the cut"; },
                 [](const request::ShowHandles&) { return "Cannot show handles"; },
                 [](const request::MakeSplint&) { return "Cannot make the splint"; },
                 [](const request::HideSplint&) { return "Cannot hide the splint"; },
                 [](const request::SavePlan&) { return "Cannot save the plan"; },
                 [](const request::SaveSession&) { return "Cannot save the session"; },
                 [](const request::Recover&) { return "Cannot recover the session"; },
                 [](const request::Browse&) { return "Cannot show the file dialog"; },
                 [](const request::ReadSeries&) { return "Cannot read this series"; },
                 [](const request::ShowCt&) { return "Cannot show this CT"; },
                 [](const request::MakeCtPatient&) { return "Cannot make a patient of this CT"; },
                 [](const request::CloseCt&) { return "Cannot close the CT"; }},
      request);
}

}  // namespace

void ViewSession::open(const fs::path& path) {
  state_.try_or_report("Cannot open this", [&] {
    if (path.empty() || is_head_name(path.string()))
      loader_.open(path);
    else
      open_files({path});
  });
}

void ViewSession::begin(const fs::path& path) {
  first_path_ = path;
  bool asks = false;
  state_.try_or_report("Cannot recover a session", [&] { asks = saving_session_.begin(); });
  if (!asks) open(path);
}

void ViewSession::recover(const request::Recover& answer) {
  if (saving_session_.recover(answer)) return;
  if (saving_session_.recovering())
    loader_.open_session(answer.file);
  else
    open(first_path_);
}

/// The session that was saved at the user's request.
void ViewSession::take_saved_session() {
  if (loader_.job().active()) return;
  const auto saved = saving_session_.update();
  if (!saved) return;
  state_.session = *saved;
  recent_.add(*saved);
  state_.scene.session = *saved;
  state_.scene.recent = recent_.list();
  state_.front_end.update_scene(state_.scene);
  state_.front_end.say("Saved the session as " + saved->string());
}

/// What the user has chosen in the dialog of the desktop.
void ViewSession::take_chosen_files() {
  const auto answer = dialog_.take();
  if (!answer) return;
  using Purpose = request::Browse::Purpose;
  if (!answer->trouble.empty())
    return state_.front_end.report_error("The file dialog failed",
                                         answer->trouble + ". Type the path instead.");
  if (answer->files.empty()) return;
  const fs::path& file = answer->files.front();
  if (answer->asked.purpose == Purpose::open) carry_out(request::Open{answer->files});
  // The dialog has asked before it replaces a file.
  if (answer->asked.purpose == Purpose::save_session) carry_out(request::SaveSession{file, true});
  if (answer->asked.purpose == Purpose::record_folder) state_.front_end.set_record_folder(file);
}

void ViewSession::carry_out(const Request& request) {
  const Overloaded act{
      [&](const request::Open& open) { open_files(open.files); },
      [&](const request::Import& files) {
        close_ct();
        loader_.import(files);
      },
      [&](const request::Record& record) { recording_.record(record, preview_.paths()); },
      [&](const request::StopRecording&) { recording_.stop(); },
      [&](const request::ResumeRecording&) { recording_.resume(); },
      [&](const request::ReplaceRecording&) { recording_.replace(); },
      [&](const request::Quit& quit) { recording_.quit(quit); },
      [&](const request::Cancel&) { cancel(); },
      [&](const request::Release& released) { release_.release(released.body); },
      [&](const request::SaveCase& saved) { save(saved.folder); },
      [&](const request::UseLandmarks&) {
        if (plan_.has_steps())
          throw InputError(
              "landmarks are edited before the operation: undo the steps of the plan, or open the "
              "patient without it");
        if (state_.patient) loader_.renew(state_.front_end.view().landmarks);
      },
      [&](const request::EditPlan& edit) { plan_.edit(edit); },
      [&](const request::PreviewCut& preview) { plan_.preview_cut(preview.edit); },
      [&](const request::ShowHandles& shown) { plan_.show_handles(shown.step); },
      [&](const request::MakeSplint& splint) { plan_.make_splint(splint.choice); },
      [&](const request::HideSplint&) { plan_.hide_splint(); },
      [&](const request::SavePlan& saved) { save_plan(saved.file); },
      [&](const request::SaveSession& saved) { saving_session_.save(saved); },
      [&](const request::Recover& answer) { recover(answer); },
      [&](const request::Browse& asked) {
        if (dialog_.open()) return state_.front_end.say("A file dialog is open already");
        dialog_.show(asked);
      },
      [&](const request::ReadSeries& series) {
        ct_.read(series.number, series.interpolate);
        show_ct();
      },
      [&](const request::ShowCt& shown) {
        ct_.choose(shown.choice);
        show_ct();
      },
      [&](const request::MakeCtPatient& made) { make_ct_patient(made.folder); },
      [&](const request::CloseCt&) { close_ct(); },
  };
  state_.try_or_report(title_of_failure(request), [&] { std::visit(act, request); });
}

void ViewSession::open_files(const std::vector<fs::path>& files) {
  if (files.empty()) {
    close_ct();
    return loader_.open({});
  }
  const fs::path& one = files.front();
  std::error_code ignored;
  if (!fs::exists(one, ignored)) {
    recent_.forget(one);
    if (state_.patient) show_scene();
    throw InputError(one, "", "does not exist (any more)");
  }
  std::vector<fs::path> surfaces;
  std::vector<std::string> others;
  for (const fs::path& file : with_loose_surfaces(files)) {
    if (makes_patient(kind_of(file)))
      surfaces.push_back(file);
    else
      others.push_back(file.filename().string());
  }
  if (!surfaces.empty()) {
    if (!others.empty())
      state_.front_end.say(
          fmt::format("Left out: {}. Only surfaces, landmarks and muscles make a patient",
                      fmt::join(others, ", ")));
    return state_.front_end.ask_roles({.files = proposed_roles(surfaces)});
  }
  if (const auto scan = scan_of(files)) return open_scan(*scan);
  if (files.size() > 1)
    state_.front_end.say(
        fmt::format("Of {} files the first is opened: {}", files.size(), one.filename().string()));
  open_file(one);
}

/// Opens a case, or a motion for the present patient.
void ViewSession::open_file(const fs::path& file) {
  switch (kind_of(file)) {
    case FileKind::patient:
      close_ct();
      return loader_.open(fs::is_directory(file) ? file : file.parent_path());
    case FileKind::session:
      close_ct();
      return loader_.open_session(file);
    case FileKind::plan:
      if (!state_.patient) throw InputError(file, "", "is a plan; open its patient first");
      return plan_.open(file);
    case FileKind::motion:
    case FileKind::excitations: {
      const std::string spec =
          (kind_of(file) == FileKind::excitations ? "muscles:" : "") + fs::absolute(file).string();
      return state_.front_end.change(
          [&](ViewState& view) {
            view.motion = {spec, view.motion.parameters, {}};
          },
          true);
    }
    default:
      throw InputError(
          file, "",
          "cannot be opened: it is no session, no case folder, no motion (CSV, .motion, .mot, "
          ".sto, .trc), no surface (STL, PLY, OBJ, glTF) and no scan (DICOM, NRRD, MetaImage, "
          "NIfTI)");
  }
}

void ViewSession::cancel() {
  if (ct_.job().active()) {
    ct_.cancel();
    return show_ct();
  }
  if (loader_.job().active()) return loader_.drop();
  if (plan_.checking().active() || plan_.predicting().active()) return plan_.cancel();
  release_.drop("it stays where it is");
}

void ViewSession::save(const fs::path& folder) {
  if (!state_.patient) return;
  if (saving_.active())
    return state_.front_end.say("A patient is being saved; ask again when that is done");
  saving_.start([opened = opened_, patient = state_.patient,
                 landmarks = state_.front_end.view().landmarks, folder](const Progress& progress) {
    report(progress, "saving the patient", 0.5);
    save_case(with_landmarks(patient->scene.patient, landmarks), folder);
    return Saved{opened, landmarks, folder};
  });
}

void ViewSession::save_plan(const fs::path& file) {
  plan_.save(file);
  state_.scene.plan = plan_.view();
  state_.front_end.update_scene(state_.scene);
  state_.front_end.say("Saved the plan as " + file.string());
}

void ViewSession::take_save() {
  if (!saving_.done()) return;
  state_.try_or_report("Cannot save the patient", [&] {
    const auto saved = saving_.take();
    if (!saved) return;
    WindowScene& shown = state_.scene;
    recent_.add(saved->folder);
    if (saved->opened == opened_) {
      if (!plan_.has_steps()) {  // else the folder has the patient after the operation
        state_.source = FolderSource{fs::absolute(saved->folder)};
        state_.source_landmarks.points.clear();
        for (const Landmark& one : saved->landmarks)
          state_.source_landmarks.points[one.name] = one.at_rest;
      }
      shown.landmarks = saved->landmarks;
      shown.case_folder = saved->folder;
    } else if (!shown.case_folder.empty()) {
      recent_.add(shown.case_folder);  // another patient was opened meanwhile
    }
    shown.recent = recent_.list();
    state_.front_end.update_scene(shown);
    state_.front_end.say("Saved the patient in " + saved->folder.string());
  });
}

}  // namespace condyle
