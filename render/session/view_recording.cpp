#include "render/session/view_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "engine/core/hash.h"
#include "render/image/colour_map.h"
#include "render/recording/caption.h"
#include "render/recording/frame_renderer.h"
#include "render/recording/recording_identity.h"
#include "render/scene/face_shape.h"
#include "render/session/view_overlays.h"
#include "sim/muscles/expression_names.h"
#include "sim/session/background_work.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

/// The motion as the window shows it: constant where a hand or the slider holds the jaw,
/// with the expression of the sliders.
Motion seen_motion(const ViewRecording& subject) {
  Motion motion = subject.motion->motion;
  const auto& tissue = subject.patient->scene.tissue;
  if (tissue && !subject.view.expression.empty())
    motion.expression = [moved = motion.expression,
                         by_sliders = excitation_of(subject.view.expression,
                                                    face_muscles_of(*tissue))](double time_s) {
      return added_excitations(moved ? moved(time_s) : FaceExcitation{}, by_sliders);
    };
  if (!subject.held_jaw) return motion;
  motion.target = [pose = *subject.held_jaw](double) { return pose; };
  motion.muscles = {};
  return motion;
}

/// Targets of bodies that the motion does not drive, in their parents' frames; at rest where no
/// hand has moved them.
std::vector<Pose> hand_poses(const ViewRecording& subject) {
  std::vector<Pose> X_PB(subject.patient->scene.patient.bodies.bodies().size());
  for (const MovableBody& body : subject.bodies)
    if (body.roams()) X_PB[index_of(body.body)] = subject.view.hands.of(body).value_or(Pose{});
  return X_PB;
}

/// Overlays and other settings of the window beside the parts at their poses.
std::uint64_t shown_hash(const ViewRecording& subject, const PicturePlan& plan) {
  using Json = nlohmann::json;
  const auto list = [](const auto& v) { return Json(std::vector(v.data(), v.data() + v.size())); };
  const auto pose = [&](const Pose& X) { return Json{list(X.R.coeffs()), list(X.t)}; };
  const auto lists = [&](const auto& points) {
    Json all;
    for (const auto& point : points) all.push_back(list(point));
    return all;
  };
  const auto parts = [](const std::vector<PartView>& views) {
    Json all;
    for (const PartView& one : views) all.push_back({one.shown, one.opacity});
    return all;
  };
  Json shown;
  // Complete: a new field does not compile until it is added here.
  const auto& [width, height, samples, shadows, coarse, contacts, folds, life, before_operation,
               backdrop, transparent, skin_opacity, part_opacity, clip, cut_away, ghost, wireframe,
               mapped_up_to, from_x, to_x, smooth_edges, supersampling] = plan.settings;
  shown["picture"] = {
      {samples, shadows, coarse, contacts, folds, before_operation, backdrop, transparent,
       skin_opacity, from_x, to_x},
      {smooth_edges, supersampling, part_opacity, wireframe, mapped_up_to.value_or(-1)}};
  if (life) {
    const auto& [nodding_axis, nose_tip, lids] = *life;
    shown["life"] = {list(nodding_axis), nose_tip ? list(*nose_tip) : Json()};
    if (lids != LidStrength{}) shown["life_lids"] = {lids.left, lids.right};
  }
  if (clip) shown["clip"] = {list(clip->point), list(clip->normal), clip->capped, clip->parts};
  if (cut_away) shown["cut"] = {list(cut_away->center), cut_away->radius_mm, cut_away->parts};
  if (ghost) shown["ghost"] = {ghost->parts, ghost->opacity, list(ghost->color)};
  shown["notes"] = {plan.annotations.scale_bar,
                    plan.annotations.letters,
                    plan.annotations.backdrop,
                    plan.caption,
                    plan.map,
                    plan.wipe.value_or(-1)};
  if (const auto& kept = plan.before) {
    shown["kept"] = {kept->state_hash,
                     pose(kept->poses[subject.patient->scene.patient.jaw.lower_arch])};
    if (kept->lids.any()) shown["kept_lids"] = {kept->lids.left, kept->lids.right};
  }
  if (const auto& operation = plan.operation) {
    for (const RemovedPart& removed : operation->removed)
      shown["removed"].push_back(mesh_hash(removed.part.mesh));
    shown["added"] = operation->added;
  }
  const auto overlaid = OverlayInputs::of(subject.view, subject.paths);
  const auto& [springs, prisms, bone_springs, axes, paths, facial_muscles, muscle_labels, muscles,
               layers, mirrored, known, bellies] = overlaid;
  shown["overlays"] = {{springs, prisms, bone_springs, axes, paths, facial_muscles, muscle_labels},
                       {parts(muscles), parts(layers), mirrored}};
  if (paths && known)
    shown["paths"] = {lists(known->ends), lists(known->colors), lists(known->dots)};
  for (const Pose& X_PB : hand_poses(subject)) shown["bodies"].push_back(pose(X_PB));
  const std::string text = shown.dump();
  return hash_bytes(text.data(), text.size());
}

/// The picture plan that a command line would state, from the window and its panel.
PicturePlan plan_of(const ViewRecording& subject) {
  const request::Record& record = subject.record;
  const Look& look = subject.view.look;
  check_cameras(record.cameras);
  caption_lines(record.caption, 0, {}, "");
  PicturePlan plan;
  plan.annotations = {.scale_bar = look.scale_bar, .letters = look.letters, .caption = {}};
  plan.near_mm = DistanceBands{}.near_mm;
  plan.caption = record.caption;
  plan.cameras = record.cameras;
  plan.before = record.kept;
  plan.operation = record.before;
  plan.window = WindowPicture{.camera = record.camera, .upright = record.upright};
  plan.window->overlays = [&subject, bellies = std::shared_ptr<const MuscleBellies>()](
                              const FrameState& frame) mutable {
    const SessionPatient& patient = *subject.patient;
    if (!bellies && shows_muscles(subject.view))
      bellies = std::make_shared<const MuscleBellies>(patient.muscles, patient.scene.patient);
    return view_overlays(patient, subject.motion->motion, frame, subject.view, subject.paths,
                         bellies.get());
  };
  if (look.wipe) plan.wipe = look.wipe_at;
  if (subject.view.distances) plan.map = SurfaceMap::distance;
  if (look.displacement) plan.map = SurfaceMap::displacement;
  PictureSettings& settings = plan.settings;
  settings = record.picture;
  settings.width = record.width;
  settings.height = record.height;
  settings.samples = record.edges == RecordEdges::msaa ? 4 : 1;
  settings.smooth_edges = record.edges == RecordEdges::fxaa;
  settings.supersampling = record.supersampling;
  settings.transparent = record.transparent;
  plan.annotations.backdrop = settings.backdrop;
  plan.words = {{"picture", fmt::format("as in a window {:016x}", shown_hash(subject, plan))}};
  return plan;
}

/// Times of the pictures, including the first and the last of the motion.
std::vector<double> times_of(const Motion& motion, double frames_per_second) {
  const int count =
      std::max(1, static_cast<int>(std::lround(motion.duration_s * frames_per_second)) + 1);
  std::vector<double> times_s = {0};
  for (int i = 1; i < count; ++i) times_s.push_back(motion.duration_s * i / (count - 1));
  return times_s;
}

std::string draw(const PicturePlan& plan, const RecordingFiles& files, const RecordingSubject& of,
                 Playback& playback, const std::vector<double>& times_s, const Progress& progress) {
  // The pictures' folders first: one that cannot be written fails at once.
  FrameRenderer pictures(plan, files, of);
  for (int i = 0; i < of.frames; ++i) {
    report(progress, fmt::format("picture {} of {}", i + 1, of.frames),
           static_cast<double>(i) / std::max(1, of.frames - 1));
    pictures.take(i, playback.at(times_s[static_cast<std::size_t>(i)]),
                  [](int, const FrameState&) {});
  }
  report(progress, files.film ? "making the film" : "writing the last pictures", 1);
  pictures.finish();
  const auto made = files.film && plan.cameras.size() == 1 ? files.out / "film.mp4" : files.out;
  std::string notes = pictures.facts().shortfall();
  if (shows_life(of.scene.patient.parts, plan.settings))
    notes += std::string(notes.empty() ? "" : "; ") + "with life, look only";
  return "Recorded " + made.string() + (notes.empty() ? "" : " (" + notes + ")");
}

/// The differences in readable words.
std::string words_of(const std::vector<std::string>& entries) {
  static const std::map<std::string, std::string> words = {
      {"camera", "camera"},
      {"case", "patient"},
      {"condyle", "version of Condyle"},
      {"frames", "number of pictures"},
      {"frames_per_second", "pictures per second"},
      {"height", "size"},
      {"width", "size"},
      {"picture", "what is shown"}};
  std::set<std::string> words_of_entries;
  for (const auto& entry : entries) {
    const auto known = words.find(entry);
    words_of_entries.insert(known == words.end() ? entry : known->second);
  }
  return fmt::format("{}", fmt::join(words_of_entries, ", "));
}

}  // namespace

ViewRecorded record_view(const ViewRecording& subject, Existing existing,
                         const SimulatorSettings& settings, const Progress& progress) {
  using End = ViewRecorded::End;
  report(progress, "preparing the recording", 0);
  const request::Record& record = subject.record;
  const Scene& scene = subject.patient->scene;
  const Motion motion = seen_motion(subject);
  const std::vector<double> times_s = times_of(motion, record.frames_per_second);
  SimulatorSettings recorded = settings;
  recorded.face = true;
  const PicturePlan plan = plan_of(subject);
  const RecordingFiles files = {.out = fs::absolute(record.folder).lexically_normal(),
                                .film = record.film,
                                .resume = existing == Existing::resume};
  const RecordingSubject of = {
      .scene = scene,
      .motion = motion,
      .settings = recorded,
      .frames = static_cast<int>(times_s.size()),
      .frames_per_second = record.frames_per_second,
      .identity = recording_identity(scene, motion, times_s, recorded, subject.view.obey_contact)};
  const std::size_t all = plan.cameras.size() * times_s.size();
  const std::string folder = files.out.string();
  const auto what_is_there = [&](const RecordingThere& there) {
    return there.differs.empty()
               ? fmt::format("{} of {} pictures are in {}", there.pictures, all, folder)
               : fmt::format("{} holds {} pictures of another recording; it differs in: {}", folder,
                             there.pictures, words_of(there.differs));
  };
  if (existing == Existing::ask) {
    const RecordingThere there = recording_there(plan, files, of);
    if (there.pictures > 0) return {End::asks, what_is_there(there), there};
  }
  Motion as_played = motion;
  as_played.recorded = !subject.view.obey_contact;  // contact does not alter it
  ViewRecorded ended;
  try {
    Playback playback(scene, as_played, recorded, false, hand_poses(subject));
    return {End::made, draw(plan, files, of, playback, times_s, progress), {}};
  } catch (const Cancelled&) {
    ended.end = End::stopped;
  } catch (const std::exception& error) {
    ended = {End::failed, error.what(), {}};
  }
  ended.there = recording_there(plan, files, of);
  if (ended.end == End::stopped) ended.words = what_is_there(ended.there);
  return ended;
}

}  // namespace condyle
