#include <fmt/format.h>

#include <algorithm>

#include "engine/core/error.h"
#include "sim/frame/part_names.h"
#include "sim/motion/measures.h"
#include "tools/view_session.h"

// Of a ViewSession: what the person asks for once, and what comes of it.

namespace condyle {
namespace fs = std::filesystem;
namespace {

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

std::string end_of(const JawLetGo& course, double opening_mm) {
  switch (course.lies_on) {
    case JawLetGo::On::teeth:
      return fmt::format("lies on its teeth with {:.1f} N", course.bite_N);
    case JawLetGo::On::flat_bite:
      return "lies on a flat bite";
    case JawLetGo::On::bone:
      return fmt::format("lies on bone, {:.1f} mm open,", opening_mm);
    case JawLetGo::On::nothing:
      break;
  }
  return fmt::format("hangs {:.1f} mm open", opening_mm);
}

/// A folder that is no case stands for the surfaces, landmarks and muscles in it, if there are any.
std::vector<fs::path> with_loose_surfaces(const std::vector<fs::path>& files) {
  std::vector<fs::path> all;
  for (const fs::path& file : files) {
    std::error_code ignored;
    std::vector<fs::path> inside;
    if (fs::is_directory(file, ignored) &&
        (!fs::exists(file / "case.json", ignored) || has_foreign_case_file(file)))
      for (fs::directory_iterator one(file, ignored), end; !ignored && one != end;
           one.increment(ignored))
        if (makes_patient(kind_of(one->path()))) inside.push_back(one->path());
    std::sort(inside.begin(), inside.end());
    if (inside.empty()) inside = {file};
    all.insert(all.end(), inside.begin(), inside.end());
  }
  return all;
}

}  // namespace

void ViewSession::open(const fs::path& path) {
  if (path.empty()) return open_patient({});
  guarded([&] { carry_out(wish::Open{{path}}); });
}

std::string ViewSession::name_of(const MovableBody& body) const {
  return readable_name(patient_->scene.patient.parts[body.part].name);
}

void ViewSession::carry_out(const wish::Open& wanted) {
  if (wanted.files.empty()) return open_patient({});
  const fs::path& one = wanted.files.front();
  std::error_code ignored;
  if (!fs::exists(one, ignored)) {
    recent_.forget(one);
    if (patient_) show_scene();
    throw InputError(one, "", "is not there (any more)");
  }
  std::vector<fs::path> surfaces;
  std::vector<std::string> others;
  for (const fs::path& file : with_loose_surfaces(wanted.files)) {
    if (makes_patient(kind_of(file)))
      surfaces.push_back(file);
    else
      others.push_back(file.filename().string());
  }
  if (!surfaces.empty()) {
    if (!others.empty())
      window_.say(fmt::format("Left out: {}. Only surfaces, landmarks and muscles make a patient",
                              fmt::join(others, ", ")));
    return window_.ask_roles({.files = proposed_roles(surfaces)});
  }
  if (wanted.files.size() > 1)
    window_.say(fmt::format("Of {} files the first is opened: {}", wanted.files.size(),
                            one.filename().string()));
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
                       "cannot be opened: it is no case folder, no motion (CSV, .motion, .mot, "
                       ".sto, .trc) and no surface (STL, PLY, OBJ, glTF)");
  }
}

void ViewSession::carry_out(const wish::Import& wanted) {
  load([wanted](const Progress&) { return import_files(wanted); }, {}, "reading the surfaces");
}

void ViewSession::carry_out(const wish::Record& wanted) {
  if (recording_ || !motion_) return;
  std::optional<Pose> held_jaw = window_.view().hands.X_CM_wanted();
  if (!held_jaw && window_.view().opening_mm && newest_) held_jaw = newest_->X_CM_wanted;
  record(std::make_shared<ViewRecording>(ViewRecording{.wanted = wanted,
                                                       .view = window_.view(),
                                                       .bodies = shown_.bodies,
                                                       .held_jaw = held_jaw,
                                                       .patient = patient_,
                                                       .motion = motion_,
                                                       .paths = paths_,
                                                       .options = options_.motion}),
         Existing::ask);
}

void ViewSession::carry_out(const wish::Cancel&) {
  if (loading_) return retire(loading_);
  drop_let_go("it stays where it is");
}

void ViewSession::carry_out(const wish::LetGo& wanted) {
  if (letting_go_ || !newest_ || wanted.body >= shown_.bodies.size()) return;
  hold_fall();
  const MovableBody& body = shown_.bodies[wanted.body];
  if (!body.free) return let_jaw_go(wanted.body);
  // All else stands still until it lies.
  window_.change([&](ViewState& view) {
    if (std::exchange(view.playing, false)) view.time_s = newest_->time_s;
  });
  loosed_ = Loosed::now(body, name_of(body), window_.view());
  letting_go_ =
      beside<LetGoResult>([patient = patient_, body, name = loosed_.name, number = wanted.body,
                           frame = *newest_, threads = common_.threads](const Progress& progress) {
        const Case& of = patient->scene.patient;
        LetGoSettings settings;
        settings.push_N = push_toward_bone(frame, body.part);
        const LetGo settled = let_go(of, body.part, frame.poses(), settings, threads, progress);
        if (!settled.rest.reached)
          throw InputError(of.parts[body.part].name +
                           ": did not come to rest; move it nearer to the bone");
        const Pose now = pose_of(of.parts, body.part, settled.poses);
        return LetGoResult{number,
                           carrier_pose(body, frame.X_CM).inverse() * now,
                           fmt::format("The {} lies still after {:.2f} s on {} place{}", name,
                                       settled.rest.seconds, settled.contacts.size(),
                                       settled.contacts.size() == 1 ? "" : "s"),
                           {}};
      });
}

void ViewSession::carry_out(const wish::SaveCase& wanted) {
  if (!patient_) return;
  if (saving_) return window_.say("A patient is being saved; ask again when that is done");
  saving_ =
      beside<Saved>([opened = opened_, patient = patient_, landmarks = window_.view().landmarks,
                     folder = wanted.folder](const Progress& progress) {
        report(progress, "saving the patient", 0.5);
        save_case(with_landmarks(patient->scene.patient, landmarks), folder);
        return Saved{opened, landmarks, folder};
      });
}

void ViewSession::carry_out(const wish::UseLandmarks&) {
  if (!patient_) return;
  const auto landmarks = window_.view().landmarks;
  load([patient = patient_,
        landmarks](const Progress&) { return with_landmarks(patient->scene.patient, landmarks); },
       patient_->folder, "making the patient with these landmarks");
  renewing_ = landmarks;
}

/// The jaw is caught where it is, and falls from there.
void ViewSession::let_jaw_go(std::size_t number) {
  if (!motion_) return;
  const MovableBody& body = shown_.bodies[number];
  const BodyPoses from = newest_->poses();
  const Pose& X_CM = from.X_CM;
  const double time_s = window_.view().time_s;
  const Hands before = window_.view().hands;
  window_.change(
      [&](ViewState& view) { view.move(body, body.skull ? view.hands.X_RC(X_CM) : X_CM, X_CM); },
      true);
  loosed_ = Loosed::now(body, name_of(body), window_.view());
  loosed_.before = before;
  letting_go_ = beside<LetGoResult>([patient = patient_, motion = motion_, number, time_s, from,
                                     options = options_.motion,
                                     threads = common_.threads](const Progress& progress) {
    report(progress, "letting go", 0);
    const Case& of = patient->scene.patient;
    JawLetGoSettings settings{.muscles = options.muscles,
                              .excitations = excitations_at(*motion, time_s)};
    const bool by_tone = settings.excitations.empty();
    if (by_tone) settings.X_CM_rest = rest_position(motion->choice, *patient, options, threads);
    JawLetGo course = let_go_jaw(of, patient->scene.contacts, from, settings, threads, progress);
    std::string words =
        fmt::format("{} the jaw {} after {:.2f} s{}",
                    by_tone ? "At its muscles' resting tone" : "Moved by its muscles",
                    end_of(course, measure(of, course.X_CM.back()).opening_mm), course.rest.seconds,
                    course.rest.reached ? ""
                    : course.rest.depth_mm > jaw_rest_depth_mm
                        ? fmt::format(", {:.2f} mm deep in bone", course.rest.depth_mm)
                        : ", not still yet");
    return LetGoResult{number, {}, std::move(words), std::move(course)};
  });
}

/// What the person has moved of the patient since something was let go, as words; empty for
/// nothing.
std::string ViewSession::overtaken_by() const {
  const ViewState& view = window_.view();
  if (view.motion.spec != loosed_.motion.spec) return "another motion was chosen";
  if (!(view.motion == loosed_.motion)) return "the motion was changed";
  if (view.playing) return "the motion was played";
  if (view.time_s != loosed_.time_s) return "the motion was moved to another time";
  if (view.opening_mm != loosed_.opening_mm) return "the mouth was opened or closed";
  if (!same(view.hands.of(loosed_.body), loosed_.hands.of(loosed_.body))) return "it was moved";
  if (!view.hands.same_jaws(loosed_.hands)) return "the jaw was moved";
  return view.hands == loosed_.hands ? "" : "another part was moved";
}

/// Ends the work on what is let go, and says why.
void ViewSession::drop_let_go(std::string_view why) {
  if (!letting_go_) return;
  retire(letting_go_);
  window_.say(fmt::format("The {} is not let go: {}", loosed_.name, why));
}

void ViewSession::take_let_go() {
  // What is edited meanwhile counts: the answer would be of what was wanted before.
  if (const std::string why = letting_go_ ? overtaken_by() : ""; !why.empty())
    drop_let_go(why + " before it had come to rest");
  if (!letting_go_ || !letting_go_->done()) return;
  const auto finished = std::move(letting_go_);
  guarded([&] {
    std::optional<LetGoResult> result;
    try {
      result = finished->take();
    } catch (...) {
      if (loosed_.before) window_.change([&](ViewState& view) { view.hands = *loosed_.before; });
      throw;
    }
    if (!result) return;
    const MovableBody& body = shown_.bodies.at(result->body);
    if (body.free) {
      window_.change([&](ViewState& view) { view.move(body, result->in_carrier, newest_->X_CM); },
                     true);
      return window_.say(result->words);
    }
    // What joints draw in at once is shown so that it can be followed.
    constexpr double fastest_mm_s = 250, arm_mm = 80;
    const JawLetGo& course = result->course;
    std::vector<double> shown_s = {0};
    for (std::size_t k = 1; k < course.X_CM.size(); ++k) {
      const Pose step = course.X_CM[k - 1].inverse() * course.X_CM[k];
      const double mm = (step * body.center - body.center).norm() + arm_mm * rotation_angle(step);
      shown_s.push_back(shown_s.back() + std::max(course.step_s, mm / fastest_mm_s));
    }
    // Wanted is where it comes to rest: what is edited meanwhile has nothing of its way.
    const Pose start = course.X_CM.front(), end = course.X_CM.back();
    window_.change([&](ViewState& view) {
      view.hands.move(body, body.skull ? *view.hands.X_RM * end.inverse() : end, end);
      view.falling = true;
    });
    loosed_.hands = window_.view().hands;
    falling_ = Falling{.of = std::move(*result),
                       .shown_s = std::move(shown_s),
                       .start = std::chrono::steady_clock::now(),
                       .X_CM = start};
  });
}

/// The jaw that was let go, where it is by now; what moves the patient otherwise ends its way.
void ViewSession::let_fall() {
  if (!falling_) return;
  if (const std::string why = overtaken_by(); !why.empty()) {
    hold_fall();
    return window_.say(fmt::format("The {} is on its way no more: {}", loosed_.name, why));
  }
  const double now_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - falling_->start).count();
  const auto& times = falling_->shown_s;
  const auto after = std::upper_bound(times.begin(), times.end(), now_s);
  if (after == times.end()) {
    window_.say(falling_->of.words);
    return end_fall();
  }
  falling_->X_CM = falling_->of.course.X_CM[static_cast<std::size_t>(after - times.begin()) - 1];
}

void ViewSession::end_fall() {
  if (falling_) window_.change([](ViewState& view) { view.falling = false; });
  falling_.reset();
}

/// Ends it; a jaw that nobody has taken is wanted where it is by now.
void ViewSession::hold_fall() {
  const ViewState& now = window_.view();
  if (falling_ && now.hands.same_jaws(loosed_.hands) && now.opening_mm == loosed_.opening_mm)
    window_.change([&](ViewState& view) {
      const Pose& X_CM = falling_->X_CM;
      const MovableBody& body = loosed_.body;
      view.hands.move(body, body.skull ? *view.hands.X_RM * X_CM.inverse() : X_CM, X_CM);
    });
  end_fall();
}

void ViewSession::take_save() {
  if (!saving_ || !saving_->done()) return;
  const auto finished = std::move(saving_);
  guarded([&] {
    const auto saved = finished->take();
    if (!saved) return;
    recent_.add(saved->folder);
    if (saved->opened == opened_) {
      shown_.landmarks = saved->landmarks;
      shown_.case_folder = saved->folder;
    } else if (!shown_.case_folder.empty()) {
      recent_.add(shown_.case_folder);  // another patient was opened meanwhile
    }
    shown_.recent = recent_.list();
    window_.update_scene(shown_);
    window_.say("Saved the patient in " + saved->folder.string());
  });
}

}  // namespace condyle
