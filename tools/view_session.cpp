#include "tools/view_session.h"

#include <fmt/format.h>

#include <algorithm>

#include "sim/case/landmark_names.h"
#include "sim/frame/part_names.h"
#include "sim/phantom/phantom.h"
#include "tools/distance_drawing.h"

namespace condyle {
namespace fs = std::filesystem;
ViewSession::ViewSession(Window& window, const ViewOptions& options, const CommonOptions& common)
    : window_(window),
      options_(options),
      common_(common),
      settings_(simulator_settings(options.motion, common)) {
  asked_.spec = options.motion.motion.empty() ? "opening" : options.motion.motion;
}

void ViewSession::open_patient(const fs::path& folder) {
  load(
      [folder](const Progress& progress) {
        return folder.empty() ? builtin_patient(progress) : load_case(folder);
      },
      folder, folder.empty() ? "loading the patient" : "loading " + folder.filename().string());
}

void ViewSession::load(std::function<Case(const Progress&)> read, fs::path folder,
                       std::string words) {
  retire(loading_);
  renewing_.reset();
  loading_ = beside<PatientPtr>([read = std::move(read), folder = std::move(folder),
                                 words = std::move(words),
                                 settings = settings_](const Progress& progress) {
    report(progress, words, 0);
    return make_view_patient(read(progress), folder, settings, progress);
  });
}

void ViewSession::take_patient() {
  if (!loading_ || !loading_->done()) return;
  const auto loaded = std::move(loading_);
  const auto renewed = std::exchange(renewing_, std::nullopt);
  std::optional<PatientPtr> made;
  guarded([&] { made = loaded->take(); });
  if (!made) return;
  retire(moving_);
  retire(readying_);
  retire(plotting_);
  drop_let_go(renewed ? "the patient was made anew" : "another patient was opened");
  retire(simulation_);
  retire(distances_);
  map_sent_ = coloured_ = false;
  paths_.reset();
  overlaid_.reset();
  motion_.reset();
  newest_.reset();
  end_fall();
  retire(unfinished_);
  if (!recording_) retire(recorded_);
  window_.show_unfinished("");
  const bool first = patient_ == nullptr;
  PatientPtr earlier = std::exchange(patient_, std::move(*made));
  retire(earlier);
  if (renewed) {
    WindowScene scene = scene_of_patient();
    shown_.parts = scene.parts;
    shown_.distance_remarks = std::move(scene.distance_remarks);
    shown_.bodies = std::move(scene.bodies);
    shown_.muscles = std::move(scene.muscles);
    shown_.layers = std::move(scene.layers);
    shown_.landmarks_in_use = *renewed;
    shown_.motion = asked_ = window_.view().motion;
    window_.renew_scene(shown_, patient_);
  } else {
    ++opened_;
    if (!patient_->folder.empty()) recent_.add(patient_->folder);
    // The command line's motion is for its own patient; another one opens first.
    if (!first) asked_ = {.spec = "opening", .parameters = {}, .excitations = {}};
    shown_ = scene_of_patient();
    ViewState start;
    static_cast<PanelChoice&>(start) = window_.view();  // what is at hand stays so
    window_.set_scene(shown_, start, patient_);
    show_scene();
    window_.show(patient_->at_rest);
  }
  if (!patient_->trouble.empty()) window_.report_error(in_words(patient_->trouble));
  want_motion(asked_);
}

std::string ViewSession::in_words(std::string sentence) const {
  std::vector<std::string> names = landmark_names();
  for (const Role role : {Role::upper_teeth, Role::lower_teeth, Role::upper_gums, Role::lower_gums})
    names.emplace_back(role_name(role));
  if (patient_) {
    for (const Part& part : patient_->scene.patient.parts) names.push_back(part.name);
    for (const auto& [name, at] : patient_->scene.patient.landmarks.points) names.push_back(name);
  }
  return with_readable_names(in_window_words(std::move(sentence)), names);
}

bool ViewSession::obeys_contact() const {
  return options_.motion.respect_contact || !motion_ || !motion_->motion.recorded;
}

WindowScene ViewSession::scene_of_patient() const {
  const Case& patient = patient_->scene.patient;
  const DistanceMapSettings map_settings{.pair_rules = settings_.contact.pair_rules};
  WindowScene scene{.parts = patient.parts,
                    .case_name = patient.name,
                    .distance_colours = distance_colours({.near_mm = map_settings.reach_mm}),
                    .distance_remarks = distance_remarks(patient),
                    .bodies = movable_bodies(patient.parts)};
  scene.case_folder = patient_->folder;
  scene.landmarks = scene.landmarks_in_use = patient_->landmarks;
  scene.motions = motion_names();
  scene.motion = asked_;
  scene.muscles = muscle_items(*patient_);
  scene.layers = layer_items(*patient_);
  return scene;
}

void ViewSession::show_scene() {
  const Scene& scene = patient_->scene;
  shown_.recent = recent_.list();
  shown_.notes = scene.patient.notes;
  const auto& contact_notes = scene.contacts.notes();
  shown_.notes.insert(shown_.notes.end(), contact_notes.begin(), contact_notes.end());
  shown_.motion = asked_;
  if (motion_) {
    const Motion& motion = motion_->motion;
    shown_.motion = motion_->choice;
    shown_.motion_name = motion.name;
    shown_.duration_s = motion.duration_s;
    shown_.max_opening_mm = motion_->widest_mm;
    shown_.motion_settings = motion_->settings;
    shown_.excitations = motion_->excitations;
    shown_.notes.insert(shown_.notes.end(), motion.notes.begin(), motion.notes.end());
  }
  for (std::string& note : shown_.notes) note = in_words(std::move(note));
  window_.update_scene(shown_);
}

void ViewSession::want_motion(const MotionChoice& choice) {
  asked_ = choice;
  retire(moving_);
  moving_ = beside<MotionPtr>([patient = patient_, choice, options = options_.motion,
                               threads = common_.threads](const Progress& progress) -> MotionPtr {
    report(progress, "preparing the motion", 0.5);
    return std::make_shared<ViewMotion>(make_view_motion(choice, *patient, options, threads));
  });
}

void ViewSession::take_motion() {
  if (!moving_ || !moving_->done()) return;
  const auto finished = std::move(moving_);
  std::optional<MotionPtr> made;
  guarded([&] { made = finished->take(); });
  if (!made) {
    // What was asked for cannot be: the motion stays as it was, or the jaw at rest.
    const MotionChoice rest{.spec = "rest", .parameters = {}, .excitations = {}};
    const MotionChoice back = motion_ ? motion_->choice : rest;
    if (!motion_ && asked_.spec != rest.spec) want_motion(rest);
    asked_ = back;
    window_.change([&](ViewState& view) { view.motion = back; });
    return;
  }
  retire(plotting_);
  window_.show_plots({});
  const bool was_playing = window_.view().playing;
  motion_ = *made;
  show_scene();
  retire(simulation_);
  simulation_ = std::make_shared<LiveSimulation>(patient_->scene, motion_->motion,
                                                 live_settings(settings_), motion_->opening);
  moved_ = {};
  window_.change([&](ViewState& view) {
    view.obey_contact = obeys_contact();
    view.playing = was_playing && motion_->motion.duration_s > 0;
  });
  // Sliding is felt at once when a hand moves the jaw: its fields are made before.
  if (!ready_for_ || ready_for_ != patient_) {
    ready_for_ = patient_;
    retire(readying_);
    readying_ =
        beside<bool>([patient = patient_, threads = common_.threads](const Progress& progress) {
          patient->scene.contacts.prepare_sliding(progress, threads);
          return true;
        });
  }
  plots_due_ = true;
}

void ViewSession::take_plots() {
  if (readying_ && readying_->done()) {
    guarded([&] { readying_->take(); });
    readying_.reset();
  }
  if (plots_due_ && !readying_ && motion_) {
    plots_due_ = false;
    plot_post_ = std::make_shared<PlotPost>();
    plotting_ = beside<MotionPictures>(
        [patient = patient_, motion = motion_, settings = settings_, post = plot_post_,
         obey = options_.motion.respect_contact](const Progress& progress) {
          const auto partly = [&post](MotionPictures pictures) {
            const std::lock_guard lock(post->mutex);
            post->pictures = std::move(pictures);
          };
          return motion_pictures(*patient, motion->motion, settings, obey, partly, progress);
        });
  }
  if (!plotting_) return;
  if (plotting_->done()) {
    const auto finished = std::move(plotting_);
    guarded([&] {
      if (auto pictures = finished->take()) show(std::move(*pictures));
    });
    return;
  }
  const std::lock_guard lock(plot_post_->mutex);
  if (plot_post_->pictures) show(std::move(*plot_post_->pictures));
  plot_post_->pictures.reset();
}

void ViewSession::show(MotionPictures pictures) {
  window_.show_plots(std::move(pictures.plots));
  paths_ = std::make_shared<LineSet>(std::move(pictures.paths));
}

void ViewSession::show_progress() {
  const auto show = [&](const auto& work, bool can_cancel) {
    if (!work || work->done()) return false;
    const auto [what, fraction] = work->progress();
    std::string words = what.empty() ? "working" : what;
    words.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(words.front())));
    window_.show_progress(words, fraction, can_cancel);
    busy_with_ = std::move(words);
    return true;
  };
  if (show(loading_, patient_ != nullptr) || show(moving_, false) || show(letting_go_, true) ||
      show(saving_, false) || show(readying_, false))
    return;
  window_.show_progress("", 1);
  busy_with_ = recording_ ? "recording" : "";
}

void ViewSession::turn() {
  const ViewState& view = window_.poll();
  for (const Wish& one : window_.take_wishes())
    guarded([&] { std::visit([&](const auto& wanted) { carry_out(wanted); }, one); });
  std::erase_if(ending_, [](const auto& done) { return done(); });
  take_patient();
  if (patient_ && !loading_ && !(view.motion == asked_)) want_motion(view.motion);
  take_motion();
  take_plots();
  take_recording();
  take_let_go();
  let_fall();
  take_save();
  show_progress();
  if (simulation_)
    simulate(view);
  else
    window_.draw();
}

}  // namespace condyle
