#include "render/session/view_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>
#include <variant>

#include "engine/core/error.h"
#include "render/recording/distance_drawing.h"
#include "render/scene/face_shape.h"
#include "render/session/view_overlays.h"
#include "sim/frame/part_names.h"
#include "sim/motion/motion.h"
#include "sim/muscles/expression_names.h"
#include "sim/plan/clinical_frame.h"

namespace condyle {

ViewSession::ViewSession(FrontEnd& front_end, const SessionSettings& settings)
    : state_{.front_end = front_end, .settings = settings},
      recent_(settings.keeps_files ? settings_file("recent") : std::filesystem::path{}),
      loader_(state_),
      ct_(state_.retired, state_.waker(), state_.threads()),
      plan_(state_),
      moving_(state_.retired, state_.waker()),
      readying_(state_.retired, state_.waker()),
      saving_(state_.retired, state_.waker()),
      preview_(state_),
      recording_(state_),
      release_(state_),
      live_(state_),
      saving_session_(state_, plan_) {
  asked_.spec = settings.first_motion;
}

void ViewSession::take_patient() {
  if (!loader_.job().done()) return;
  const bool of_ct = loader_.makes_ct();
  auto loaded = loader_.take();
  if (of_ct && loaded) ct_.close();
  if (!loaded) {
    if (!saving_session_.recovering()) return;
    saving_session_.recovery_failed();
    return open(first_path_);
  }
  plan_.drop();
  if (!loaded->renewed) state_.source_landmarks = std::move(loaded->source_landmarks);
  state_.source = std::move(loaded->source);
  state_.geometry = std::move(loaded->geometry);
  install(std::move(loaded->patient),
          loaded->renewed ? "the patient was rebuilt" : "another patient was opened");
  std::optional<PlanDocument> document;
  state_.try_or_report("Cannot open the plan", [&] {
    if (!loaded->plan.empty()) document = PlanDocument(loaded->plan);
  });
  plan_.begin(std::move(document), loaded->opened ? loaded->opened->saved.draft : std::nullopt);
  if (loaded->renewed)
    show_renewed_patient(*loaded->renewed);
  else
    show_new_patient(loaded->opened ? &*loaded->opened : nullptr);
  if (!state_.patient->trouble.empty())
    state_.front_end.report_error("Cannot build the soft tissue",
                                  state_.in_words(state_.patient->trouble));
  if (of_ct)
    state_.front_end.say("Saved the patient in " + state_.patient->folder.string() +
                         ". Check its landmarks: key B");
  want_motion(asked_);
}

/// The patient after an edit of its plan.
void ViewSession::take_plan() {
  auto planned = plan_.take();
  if (!planned) return;
  const std::string trouble = planned->patient->trouble;
  std::map<std::string, PartView> earlier;
  const auto& shown = state_.front_end.view().parts;
  drawn_parts_.clear();
  for (std::size_t i = 0; i < std::min(shown.size(), state_.scene.parts.size()); ++i) {
    const Part& part = state_.scene.parts[i];
    earlier[part.name] = shown[i];
    drawn_parts_.push_back(
        {part.name, part.mesh.vertices.size(),
         part.mesh.vertices.empty() ? Eigen::Vector3d::Zero().eval() : part.mesh.vertices.front()});
  }
  const std::size_t chosen = state_.front_end.view().chosen;
  const std::string body = chosen < state_.scene.bodies.size()
                               ? state_.scene.parts[state_.scene.bodies[chosen].part].name
                               : "";
  install(std::move(planned->patient), "the plan was edited");
  show_planned_patient(earlier, body, planned->stage == PlanSession::Stage::pieces);
  plan_.renew_handles();
  show_scene();
  if (!trouble.empty())
    state_.front_end.report_error("Cannot predict the face", state_.in_words(trouble));
  want_motion(asked_);
}

/// Puts a patient in the place of the present one, before it is shown.
void ViewSession::install(std::shared_ptr<const SessionPatient> patient, std::string_view why) {
  moving_.drop();
  readying_.drop();
  release_.drop(why);
  release_.end();
  live_.stop();
  preview_.forget();
  recording_.forget();
  state_.motion.reset();
  if (auto earlier = std::exchange(state_.patient, std::move(patient)))
    state_.retired.add(std::move(earlier), nullptr);
}

void ViewSession::show_renewed_patient(const std::vector<Landmark>& landmarks) {
  WindowScene scene = scene_of_patient();
  WindowScene& shown = state_.scene;
  shown.parts = scene.parts;
  shown.distance_remarks = std::move(scene.distance_remarks);
  shown.bodies = std::move(scene.bodies);
  shown.expressions = std::move(scene.expressions);
  shown.muscles = std::move(scene.muscles);
  shown.layers = std::move(scene.layers);
  shown.landmarks_in_use = landmarks;
  shown.motion = asked_ = state_.front_end.view().motion;
  state_.front_end.renew_scene(shown, state_.patient);
}

void ViewSession::show_new_patient(const OpenedSession* opened) {
  // The first motion of the settings is for the first patient; another one opens the mouth first.
  if (++opened_ > 1) asked_ = {.spec = "opening", .parameters = {}, .excitations = {}};
  if (opened) asked_ = opened->saved.view.motion;
  saving_session_.patient_shown(opened, opened_ == 1);
  resumed_.reset();
  const std::filesystem::path& own =
      state_.session.empty() ? state_.patient->folder : state_.session;
  if (!own.empty()) recent_.add(own);
  state_.scene = scene_of_patient();
  if (opened) {
    show_opened_session(*opened);
  } else {
    ViewState start;
    static_cast<PanelChoice&>(start) = state_.front_end.view();  // the panels in use stay
    state_.front_end.set_scene(state_.scene, start, state_.patient);
  }
  show_scene();
  state_.front_end.show(state_.patient->at_rest);
}

/// The part of the drawn cut in the present patient; none where that bone was cut or lies
/// elsewhere.
std::optional<std::size_t> ViewSession::drawn_part_now(const DrawnCut& drawn) const {
  if (!drawn.part || *drawn.part >= drawn_parts_.size()) return std::nullopt;
  const auto& [name, vertices, corner] = drawn_parts_[*drawn.part];
  const auto& parts = state_.patient->scene.patient.parts;
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i].name == name && parts[i].mesh.vertices.size() == vertices && vertices > 0 &&
        parts[i].mesh.vertices.front() == corner)
      return i;
  return std::nullopt;
}

void ViewSession::show_opened_session(const OpenedSession& opened) {
  state_.settings.plan.clear();  // of the first patient, instead of which a session was recovered
  std::vector<std::string> left_out;
  ViewState start = fitted_view(opened.saved, state_.scene, left_out);
  resumed_ = start;
  start.playing = false;  // until the motion is there
  state_.front_end.set_scene(state_.scene, start, state_.patient);
  state_.front_end.change([&](ViewState& view) { view.landmarks = start.landmarks; });
  state_.front_end.set_camera(opened.saved.camera);
  std::string words;
  for (const std::string& note : opened.notes) words += (words.empty() ? "" : "\n") + note;
  if (!left_out.empty())
    words += fmt::format("{}Left out: {}.", words.empty() ? "" : "\n", fmt::join(left_out, "; "));
  if (!words.empty())
    state_.front_end.report_error("The session does not fit its patient any more",
                                  state_.in_words(words));
}

/// What an opened session says of the motion, once that is there.
void ViewSession::resume_view() {
  if (!resumed_) return;
  state_.front_end.change([&](ViewState& view) {
    view.obey_contact = resumed_->obey_contact;
    view.time_s = std::min(resumed_->time_s, state_.motion->motion.duration_s);
    view.playing = resumed_->playing && state_.motion->motion.duration_s > 0;
  });
  resumed_.reset();
}

/// View and edits stay as far as they do not belong to parts that the plan has changed. `earlier`:
/// how the parts were shown, by name; `chosen`: the part of the body with handles; `new_parts`: the
/// bones are cut or lie otherwise than before.
void ViewSession::show_planned_patient(const std::map<std::string, PartView>& earlier,
                                       const std::string& chosen, bool new_parts) {
  const ViewState& view = state_.front_end.view();
  ViewState start;
  static_cast<PanelChoice&>(start) = view;
  static_cast<Edits&>(start) = view;
  start.hands = {};
  start.opening_mm.reset();
  start.measured.clear();
  start.parts.clear();
  const auto& origin = state_.patient->operated->origin;
  for (const Part& part : state_.patient->scene.patient.parts) {
    auto known = earlier.find(part.name);
    if (const auto cut = origin.find(part.name); known == earlier.end() && cut != origin.end())
      known = earlier.find(cut->second.part);
    start.parts.push_back(known == earlier.end() ? PartView{} : known->second);
  }
  const auto drawn_on = drawn_part_now(view.drawn_cut);
  WindowScene scene = scene_of_patient();
  scene.recent = state_.scene.recent;
  state_.scene = std::move(scene);
  start.tool = view.tool;
  if (new_parts) {
    start.drawn_cut.part = drawn_on;
    if (!drawn_on) {  // the bone was cut or has moved
      start.drawn_cut = {};
      if (start.tool == Tool::cut) start.tool = Tool::look;
    }
  } else {
    start.selected = view.selected;
    start.held_handle = view.held_handle;
  }
  for (std::size_t i = 0; i < state_.scene.bodies.size(); ++i)
    if (state_.scene.parts[state_.scene.bodies[i].part].name == chosen) start.chosen = i;
  state_.front_end.replace_scene(state_.scene, start, state_.patient, new_parts);
  show_scene();
  state_.front_end.show(state_.patient->at_rest);
}

bool ViewSession::obeys_contact() const {
  return state_.settings.respect_contact || !state_.motion || !state_.motion->motion.recorded;
}

/// Segments move along clinical axes, about the point that their moves are named by.
void ViewSession::use_clinical_axes(std::vector<MovableBody>& bodies) const {
  const Operated& operated = *state_.patient->operated;
  try {
    const ClinicalFrame frame = clinical_frame(operated.patient.landmarks, plan_.reference());
    for (MovableBody& body : bodies) {
      if (!body.roams()) continue;
      body.axes << frame.left, frame.back, frame.up;
      const std::string& segment = operated.patient.bodies[body.body].name;
      const std::string point = point_name({}, segment);
      if (!operated.patient.landmarks.find(point)) continue;
      body.center = operated.poses[body.body] * rotation_point(operated, segment, {});
      body.point = readable_name(point);
    }
  } catch (const InputError&) {  // without these landmarks they keep the axes of the case
  }
}

WindowScene ViewSession::scene_of_patient() const {
  const Case& patient = state_.patient->scene.patient;
  const DistanceMapSettings map_settings{.pair_rules =
                                             state_.settings.simulator.contact.pair_rules};
  WindowScene scene{.parts = patient.parts,
                    .case_name = patient.name,
                    .distance_colours = distance_colours({.near_mm = map_settings.reach_mm}),
                    .distance_remarks = distance_remarks(patient, state_.patient->surfaces->open),
                    .bodies = movable_bodies(patient.parts, patient.bodies)};
  use_clinical_axes(scene.bodies);
  scene.has_midsagittal_plane = midsagittal_plane(*state_.patient).has_value();
  scene.case_folder = state_.patient->folder;
  scene.session = state_.session;
  scene.ct = ct_.view();
  scene.landmarks = scene.landmarks_in_use = landmarks_of(*state_.patient);
  scene.motions = motion_names(state_.patient->scene);
  scene.motion = asked_;
  scene.expressions = expression_items(*state_.patient);
  scene.muscles = muscle_items(*state_.patient);
  scene.layers = layer_items(*state_.patient);
  scene.plan = plan_.view();
  if (auto before = before_operation(*state_.patient))
    scene.before = std::make_shared<const BeforeOperation>(std::move(*before));
  return scene;
}

/// A sentence on what the sliders of the face ask for, or the lids of the motion, and the patient
/// lacks; empty: nothing.
std::string ViewSession::lacking_for_face() {
  if (!state_.patient->scene.tissue) return {};
  std::string lacking;
  bool moves_lids = state_.motion && motion_moves_lids_;
  const auto& expression = state_.front_end.view().expression;
  if (!expression.empty() && !state_.scene.expressions.empty()) {
    const auto& muscles = face_muscles_of(*state_.patient->scene.tissue);
    lacking = missing_kinds(expression, muscles);
    moves_lids |= excitation_of(expression, muscles).moves_lids();
  }
  if (!moves_lids) return lacking;
  if (lids_note_.of.lock() != state_.patient)
    lids_note_ = {state_.patient, lids_note(state_.patient->scene.patient.parts)};
  if (!lacking.empty() && !lids_note_.text.empty()) lacking += "; ";
  return lacking + lids_note_.text;
}

/// Sentences on expression, motion, soft tissue, contact and patient: what changed last comes
/// first.
std::vector<std::string> ViewSession::notes() const {
  const Scene& scene = state_.patient->scene;
  std::vector<std::string> notes;
  const auto add = [&notes](const std::vector<std::string>& more) {
    notes.insert(notes.end(), more.begin(), more.end());
  };
  if (state_.motion) add(state_.motion->motion.notes);
  if (!lacking_for_face_.empty() &&
      std::find(notes.begin(), notes.end(), lacking_for_face_) == notes.end())
    notes.insert(notes.begin(), lacking_for_face_);
  // As on the terminal, those on the mesh of the built-in patient's tissue are left out.
  if (scene.tissue && !std::holds_alternative<BuiltInSource>(state_.source))
    for (const std::string& note : summary(*scene.tissue).notes)
      notes.push_back("soft tissue: " + note);
  add(scene.contacts.notes());
  add(scene.patient.notes);
  for (std::string& note : notes) note = state_.in_words(std::move(note));
  return notes;
}

/// The notes after a slider of the face was moved.
void ViewSession::follow_expression() {
  if (!state_.patient) return;
  std::string lacking = lacking_for_face();
  if (lacking == lacking_for_face_) return;
  lacking_for_face_ = std::move(lacking);
  state_.scene.notes = notes();
  state_.show_changes();
}

void ViewSession::show_scene() {
  WindowScene& shown = state_.scene;
  shown.recent = recent_.list();
  lacking_for_face_ = lacking_for_face();
  shown.motion = asked_;
  if (state_.motion) {
    const Motion& motion = state_.motion->motion;
    if (!moving_.active()) shown.motion = state_.motion->choice;
    shown.motion_name = motion.name;
    shown.duration_s = motion.duration_s;
    shown.max_opening_mm = state_.motion->widest_mm;
    shown.motion_settings = state_.motion->settings;
    shown.excitations = state_.motion->excitations;
  }
  shown.notes = notes();
  state_.front_end.update_scene(shown);
}

void ViewSession::want_motion(const MotionChoice& choice) {
  asked_ = choice;
  moving_.start([patient = state_.patient, choice,
                 settings = state_.settings](const Progress& progress) mutable {
    report(progress, "preparing the motion", 0.5);
    settings.motion.progress = [&](std::string_view, double) {
      report(progress, "preparing the motion", 0.5);
    };
    return std::make_shared<const SessionMotion>(make_session_motion(choice, *patient, settings));
  });
}

/// The requested motion is impossible: the previous one stays, or the jaw at rest.
void ViewSession::keep_motion() {
  const MotionChoice rest{.spec = "rest", .parameters = {}, .excitations = {}};
  const MotionChoice back = state_.motion ? state_.motion->choice : rest;
  if (!state_.motion && asked_.spec != rest.spec) want_motion(rest);
  asked_ = back;
  state_.front_end.change([&](ViewState& view) { view.motion = back; });
}

void ViewSession::take_motion() {
  if (!moving_.done()) return;
  std::optional<std::shared_ptr<const SessionMotion>> made;
  state_.try_or_report("Cannot make this motion", [&] {
    auto taken = moving_.take();
    motion_lifts_brows_ = taken && motion_moves_upper_face((*taken)->choice.spec);
    motion_moves_lids_ = taken && motion_moves_lids((*taken)->choice.spec);
    made = std::move(taken);
  });
  if (!made) return keep_motion();
  preview_.restart();
  const bool was_playing = state_.front_end.view().playing;
  state_.motion = *made;
  show_scene();
  live_.start();
  state_.front_end.change([&](ViewState& view) {
    view.obey_contact = obeys_contact();
    view.playing = was_playing && state_.motion->motion.duration_s > 0;
  });
  resume_view();
  prepare_sliding();
}

/// Prepares the distance fields in advance, so that a hand can move the jaw without delay.
void ViewSession::prepare_sliding() {
  if (ready_for_ && ready_for_ == state_.patient) return;
  ready_for_ = state_.patient;
  readying_.start([patient = state_.patient, threads = state_.threads()](const Progress& progress) {
    patient->scene.contacts.prepare_sliding(progress, threads);
    return true;
  });
}

void ViewSession::show_progress() {
  const auto show = [&](const auto& job, bool can_cancel) {
    if (!job.active() || job.done()) return false;
    const auto [what, fraction] = job.progress();
    std::string words = what.empty() ? "working" : what;
    words.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(words.front())));
    state_.front_end.show_progress(words, fraction, can_cancel);
    busy_with_ = std::move(words);
    return true;
  };
  if (show(loader_.job(), state_.patient != nullptr || loader_.makes_ct()) ||
      show(ct_.job(), true) || show(plan_.checking(), true) || show(moving_, false) ||
      show(release_.job(), true) || show(saving_, false) || show(plan_.splinting(), false) ||
      show(plan_.colliding(), false) || show(plan_.predicting(), true) || show(readying_, false))
    return;
  state_.front_end.show_progress("", 1);
  busy_with_ = recording_.active() ? "recording" : "";
}

/// Once sliders or the motion move brows or forehead, the soft tissue is built again with these;
/// after that was cancelled, only once they have been at rest.
void ViewSession::extend_face(const ViewState& view) {
  bool& upper_face = state_.settings.simulator.tissue_model.upper_face;
  if (loader_.job().active() || plan_.checking().active() || plan_.colliding().active() ||
      plan_.predicting().active() || !state_.patient)
    return;
  const bool moves = moves_upper_face(view.expression) || (state_.motion && motion_lifts_brows_);
  const bool cancelled = face_asked_for_ == state_.patient;
  if (!moves && cancelled) {
    upper_face = false;
    face_asked_for_ = nullptr;
  }
  if (!moves || upper_face || !state_.patient->scene.tissue) return;
  upper_face = true;
  face_asked_for_ = state_.patient;
  if (state_.patient->scene.plan)
    plan_.renew_face();
  else
    loader_.renew(state_.scene.landmarks_in_use);
}

void ViewSession::turn() {
  const ViewState& view = state_.front_end.poll();
  for (const Request& request : state_.front_end.take_requests()) carry_out(request);
  state_.retired.sweep();
  take_patient();
  take_ct();
  take_plan();
  const bool has_splint = plan_.take_splint();
  if (has_splint) state_.scene.plan = plan_.view();
  const bool has_preview = plan_.take_preview(), moved_by_hand = plan_.follow_hand();
  if (has_preview || has_splint || moved_by_hand) state_.show_changes();
  extend_face(view);
  follow_expression();
  if (state_.patient && !loader_.job().active() && !(view.motion == asked_))
    want_motion(view.motion);
  take_motion();
  if (readying_.done()) state_.try_or_report("Cannot prepare contact", [&] { readying_.take(); });
  preview_.update(!readying_.active());
  recording_.update();
  release_.update();
  take_save();
  take_saved_session();
  take_chosen_files();
  show_progress();
  if (live_.running())
    live_.update(view, release_.X_CM(), preview_.paths());
  else
    state_.front_end.draw();
}

}  // namespace condyle
