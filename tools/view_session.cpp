#include "tools/view_session.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "sim/phantom/phantom.h"
#include "tools/distance_drawing.h"
#include "tools/view_recording.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

std::vector<MapSurface> map_surfaces(const DistanceMap& map) {
  std::vector<MapSurface> surfaces;
  for (const auto& surface : map.surfaces())
    surfaces.push_back({static_cast<std::size_t>(surface.part), &surface.mesh, surface.normals});
  return surfaces;
}

/// Tells the simulation what the hands want otherwise than before. A free part that is put back is
/// wanted where it was loaded.
void hand_over(const Hands& now, const Hands& before, std::span<const MovableBody> bodies,
               LiveSimulation& simulation) {
  for (const auto& body : bodies) {
    Hands one, other;
    one.of(body) = now.of(body);
    other.of(body) = before.of(body);
    if (one == other) continue;
    if (now.of(body) || body.free)
      simulation.drag(body.part, now.of(body).value_or(Pose{}));
    else
      simulation.release(body.part);
  }
}

/// Where a part that is let go is pushed: to the bone that is nearest, with a newton.
Eigen::Vector3d push_toward_bone(const FrameState& frame, std::size_t part) {
  double nearest = 1e300;
  Eigen::Vector3d way = -Eigen::Vector3d::UnitZ();
  for (const auto& pair : frame.contacts.pairs) {
    const bool first = pair.part_a == static_cast<int>(part);
    if ((!first && pair.part_b != static_cast<int>(part)) || pair.distance_is_bound) continue;
    if (pair.touching || pair.distance_mm >= nearest) continue;
    nearest = pair.distance_mm;
    way = first ? pair.witness_b - pair.witness_a : pair.witness_a - pair.witness_b;
  }
  return way.norm() > 1e-9 ? way.normalized() : -Eigen::Vector3d::UnitZ();
}

}  // namespace

ViewSession::ViewSession(Window& window, const ViewOptions& options, const CommonOptions& common)
    : window_(window),
      options_(options),
      common_(common),
      settings_(simulator_settings(options.motion, common)) {
  asked_.spec = options.motion.motion.empty() ? "opening" : options.motion.motion;
}

template <class Work>
void ViewSession::guarded(const Work& work) {
  try {
    work();
  } catch (const std::exception& error) {
    window_.report_error(error.what());
  }
}

template <class Result>
std::unique_ptr<Background<Result>> ViewSession::beside(
    std::function<Result(const Progress&)> work) const {
  return std::make_unique<Background<Result>>(std::move(work), [] { Window::wake(); });
}

template <class Result>
void ViewSession::retire(std::unique_ptr<Background<Result>>& work) {
  if (!work) return;
  work->cancel();
  std::shared_ptr<Background<Result>> ending = std::move(work);
  ending_.push_back([ending] { return ending->done(); });
}

void ViewSession::open_patient(const fs::path& folder) {
  load(
      [folder](const Progress& progress) {
        return folder.empty() ? builtin_patient(progress) : load_case(folder);
      },
      folder);
}

void ViewSession::load(std::function<Case(const Progress&)> read, fs::path folder) {
  retire(loading_);
  loading_ = beside<PatientPtr>([read = std::move(read), folder = std::move(folder),
                                 settings = settings_](const Progress& progress) {
    report(progress,
           folder.empty() ? "loading the patient" : "loading " + folder.filename().string(), 0);
    return make_view_patient(read(progress), folder, settings, progress);
  });
}

void ViewSession::take_patient() {
  if (!loading_ || !loading_->done()) return;
  const auto loaded = std::move(loading_);
  std::optional<PatientPtr> made;
  guarded([&] { made = loaded->take(); });
  if (!made) return;
  retire(moving_);
  retire(readying_);
  retire(plotting_);
  simulation_.reset();
  distances_.reset();
  map_sent_ = coloured_ = false;
  motion_.reset();
  newest_.reset();
  const bool first = patient_ == nullptr;
  const PatientPtr earlier = std::exchange(patient_, *made);
  if (!patient_->folder.empty()) recent_.add(patient_->folder);
  // The command line's motion is for its own patient; another one opens first.
  if (!first) asked_ = {.spec = "opening", .parameters = {}, .excitations = {}};
  show_scene(true);
  window_.show(patient_->at_rest);
  if (!patient_->trouble.empty()) window_.report_error(patient_->trouble);
  want_motion(asked_);
}

bool ViewSession::obeys_contact() const {
  return options_.motion.respect_contact || !motion_ || !motion_->motion.recorded;
}

void ViewSession::show_scene(bool other_patient) {
  const Scene& scene = patient_->scene;
  const DistanceMapSettings map_settings{.pair_rules = settings_.contact.pair_rules};
  if (other_patient) {
    shown_ = {.parts = scene.patient.parts,
              .case_name = scene.patient.name,
              .distance_colours = distance_colours({.near_mm = map_settings.reach_mm}),
              .distance_remarks = distance_remarks(scene.patient),
              .bodies = movable_bodies(scene.patient.parts)};
    shown_.case_folder = patient_->folder;
    shown_.landmarks = patient_->landmarks;
    shown_.motions = motion_names();
  }
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
    shown_.max_opening_mm = std::max(motion_->widest_mm, 1.0);
    shown_.motion_settings = motion_->settings;
    shown_.excitations = motion_->excitations;
    shown_.notes.insert(shown_.notes.end(), motion.notes.begin(), motion.notes.end());
  }
  if (other_patient)
    window_.set_scene(shown_);
  else
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
  show_scene(false);
  simulation_.reset();
  simulation_ = std::make_unique<LiveSimulation>(patient_->scene, motion_->motion, settings_);
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
  window_.show_lines("paths", std::move(pictures.paths));
}

void ViewSession::take_recording() {
  if (!recording_) return;
  if (!recording_->done()) {
    const auto [what, fraction] = recording_->progress();
    window_.show_recording(what.empty() ? "starting" : what, fraction);
    return;
  }
  const auto finished = std::move(recording_);
  window_.show_recording("", 0);
  guarded([&] {
    if (const auto made = finished->take())
      window_.say("Recorded " + made->string());
    else
      window_.say("The recording was stopped; its pictures stay in the folder");
  });
}

void ViewSession::take_let_go() {
  if (!letting_go_ || !letting_go_->done()) return;
  const auto finished = std::move(letting_go_);
  guarded([&] {
    const auto result = finished->take();
    if (!result) return;
    window_.change(
        [&](ViewState& view) {
          view.hands.of(shown_.bodies.at(result->body)) = result->in_carrier;
        },
        true);
    window_.say(result->words);
  });
}

void ViewSession::take_save() {
  if (!saving_ || !saving_->done()) return;
  const auto finished = std::move(saving_);
  guarded([&] {
    const auto folder = finished->take();
    if (!folder) return;
    recent_.add(*folder);
    shown_.recent = recent_.list();
    shown_.landmarks = window_.view().landmarks;
    shown_.case_folder = *folder;
    window_.update_scene(shown_);
    window_.say("Saved the patient in " + folder->string());
  });
}

void ViewSession::carry_out(const wish::Open& wanted) {
  if (wanted.files.empty()) return open_patient({});
  const fs::path& one = wanted.files.front();
  std::error_code ignored;
  if (!fs::exists(one, ignored)) {
    recent_.forget(one);
    if (patient_) show_scene(false);
    throw InputError(one, "", "is not there (any more)");
  }
  wish::Import surfaces;
  for (const fs::path& file : wanted.files) {
    const FileKind kind = kind_of(file);
    if (kind == FileKind::surface || kind == FileKind::landmarks)
      surfaces.files.push_back({file, role_guess(file)});
  }
  if (!surfaces.files.empty()) return window_.ask_roles(surfaces);
  switch (kind_of(one)) {
    case FileKind::patient:
      return open_patient(fs::is_directory(one) ? one : one.parent_path());
    case FileKind::motion:
    case FileKind::excitations: {
      const std::string spec =
          (kind_of(one) == FileKind::excitations ? "muscles:" : "") + fs::absolute(one).string();
      return window_.change(
          [&](ViewState& view) {
            view.motion = {spec, view.motion.parameters, {}};
          },
          true);
    }
    default:
      throw InputError(one, "",
                       "is of no kind that can be opened: give a case folder, a motion (CSV, "
                       ".motion, .mot, .sto, .trc) or a surface (STL, PLY, OBJ, glTF)");
  }
}

void ViewSession::carry_out(const wish::Import& wanted) {
  load(
      [wanted](const Progress& progress) {
        report(progress, "reading the surfaces", 0.05);
        return import_files(wanted);
      },
      {});
}

void ViewSession::carry_out(const wish::Record& wanted) {
  if (recording_ || !motion_) return;
  recording_ = beside<fs::path>([wanted, patient = patient_, motion = motion_, settings = settings_,
                                 obey = options_.motion.respect_contact](const Progress& progress) {
    return record_view(wanted, *patient, motion->motion, settings, obey, progress);
  });
}

void ViewSession::carry_out(const wish::Cancel&) {
  if (recording_) return recording_->cancel();
  if (loading_) return retire(loading_);
}

void ViewSession::carry_out(const wish::LetGo& wanted) {
  if (letting_go_ || !newest_ || wanted.body >= shown_.bodies.size()) return;
  const MovableBody& body = shown_.bodies[wanted.body];
  if (!body.free) return;
  letting_go_ =
      beside<LetGoResult>([patient = patient_, body, number = wanted.body, frame = *newest_,
                           threads = common_.threads](const Progress& progress) {
        report(progress, "letting go", 0.5);
        const Case& of = patient->scene.patient;
        LetGoSettings settings;
        settings.push_N = push_toward_bone(frame, body.part);
        const LetGo settled = let_go(of, body.part, frame.poses(), settings, threads);
        if (!settled.rest.reached)
          throw InputError(of.parts[body.part].name +
                           ": did not come to rest; move it nearer to the bone");
        const Pose now = pose_of(of.parts, body.part, settled.poses);
        return LetGoResult{number, carrier_pose(body, frame.X_CM).inverse() * now,
                           fmt::format("Lies still after {:.2f} s on {} places",
                                       settled.rest.seconds, settled.contacts.size())};
      });
}

void ViewSession::carry_out(const wish::SaveCase& wanted) {
  if (saving_ || !patient_) return;
  saving_ = beside<fs::path>([patient = patient_, landmarks = window_.view().landmarks,
                              folder = wanted.folder](const Progress& progress) {
    report(progress, "saving the patient", 0.5);
    save_case(with_landmarks(patient->scene.patient, landmarks), folder);
    return folder;
  });
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
  if (show(loading_, patient_ != nullptr) || show(moving_, false) || show(letting_go_, false) ||
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
  take_save();
  show_progress();
  if (simulation_)
    simulate(view);
  else
    window_.draw();
}

void ViewSession::simulate(const ViewState& view) {
  simulation_->request({.time_s = view.time_s,
                        .opening_mm = view.opening_mm,
                        .obey_contact = view.obey_contact,
                        .face = view.shows_face(shown_)});
  if (!(view.hands == moved_)) {
    guarded([&] { hand_over(view.hands, moved_, shown_.bodies, *simulation_); });
    moved_ = view.hands;
  }
  LoopStatistics loop{.steps_per_second = simulation_->steps_per_second(),
                      .message = view.distances && !map_sent_ ? "Measuring distances" : ""};
  std::optional<FrameState> frame;
  guarded([&] { frame = simulation_->take(); });
  const bool news = frame.has_value();
  if (news) newest_ = std::move(frame);
  if (!newest_) return window_.draw();
  if (view.look.springs && (news || !springs_shown_))
    window_.show_lines("springs", tissue_springs(patient_->scene, newest_->tissue));
  springs_shown_ = view.look.springs;
  if (view.distances && !distances_)
    distances_ = std::make_unique<LiveDistances>(
        patient_->scene.patient, DistanceMapSettings{.pair_rules = settings_.contact.pair_rules});
  const bool switched = coloured_ != view.distances;
  if (view.distances && (news || switched)) distances_->request(*newest_);
  coloured_ = view.distances;
  auto answer = distances_ ? distances_->take() : std::nullopt;
  if (answer && !map_sent_) {
    window_.set_map_surfaces(map_surfaces(*distances_->map()));
    map_sent_ = true;
    loop.message.clear();
  }
  // A frame waits for its colours, so that both are of one time.
  if (answer && view.distances)
    window_.show(std::move(answer->frame), loop, std::move(answer->values));
  else if ((news || switched) && !(view.distances && map_sent_))
    window_.show(*newest_, loop);
  else
    window_.draw();
}

}  // namespace condyle
