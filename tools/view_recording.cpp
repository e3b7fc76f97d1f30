#include "tools/view_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "render/annotations.h"
#include "render/displacement_drawing.h"
#include "render/gl_context.h"
#include "render/paint.h"
#include "render/recorder.h"
#include "render/scene_renderer.h"
#include "render/shown_overlays.h"
#include "tools/distance_drawing.h"
#include "tools/view_overlays.h"

namespace condyle {
namespace {

/// The motion as it is seen in the window: where a hand or the slider holds the jaw, it stays.
Motion seen_motion(const ViewRecording& subject) {
  Motion motion = subject.motion->motion;
  if (!subject.held_jaw) return motion;
  motion.wanted = [pose = *subject.held_jaw](double) { return pose; };
  motion.muscles = {};
  return motion;
}

/// Where free parts are wanted, in their order; as at rest where no hand has them.
std::vector<Pose> free_poses(const ViewRecording& subject) {
  std::vector<Pose> poses;
  for (const MovableBody& body : subject.bodies)
    if (body.free) poses.push_back(subject.view.hands.of(body).value_or(Pose{}));
  return poses;
}

/// Draws frames of one recording.
class ViewDrawing {
 public:
  ViewDrawing(const ViewRecording& subject, const SimulatorSettings& settings)
      : subject_(subject), renderer_(subject.patient->scene.patient.parts) {
    picture_ = subject.wanted.picture;
    picture_.width = subject.wanted.width;
    picture_.height = subject.wanted.height;
    picture_.samples = 4;
    if (subject.view.distances) {
      const DistanceBands bands;
      distances_.emplace(subject.patient->scene.patient,
                         DistanceMapSettings{.reach_mm = bands.near_mm + 1,
                                             .pair_rules = settings.contact.pair_rules},
                         settings.threads, renderer_, distance_colours(bands));
    }
    if (subject.view.look.displacement) displacement_.emplace(subject.patient->scene.patient.parts);
  }

  Image picture(const FrameState& frame, const Camera& camera) {
    Image image = drawn(frame, camera);
    const Look& look = subject_.view.look;
    if (look.wipe && subject_.wanted.kept)
      image = wiped(drawn(*subject_.wanted.kept, camera), image, look.wipe_at);
    Annotations notes = {.scale_bar = look.scale_bar, .letters = look.letters};
    add_key(image, words_, key_);
    if (distances_) keep_clear_of(notes, distances_->add_legend_to(image), image);
    if (displacement_) keep_clear_of(notes, displacement_->add_legend_to(image), image);
    annotate(image, words_, camera, notes);
    return image;
  }

 private:
  Image drawn(const FrameState& frame, const Camera& camera) {
    renderer_.update(frame);
    if (distances_) distances_->color(renderer_, frame);
    if (displacement_) displacement_->color(renderer_, frame);
    const Overlays shown = view_overlays(*subject_.patient, subject_.motion->motion, frame,
                                         subject_.view, subject_.paths);
    overlays_.send(renderer_, shown);
    key_ = shown.key;
    return renderer_.picture(camera, picture_);
  }

  const ViewRecording& subject_;
  OffscreenContext context_;
  SceneRenderer renderer_;
  OverlaySender overlays_;
  std::vector<KeyEntry> key_;  // to them
  std::optional<DistanceDrawing> distances_;
  std::optional<DisplacementDrawing> displacement_;
  Lettering words_;
  PictureSettings picture_;
};

}  // namespace

std::filesystem::path record_view(const ViewRecording& subject, const SimulatorSettings& settings,
                                  const Progress& progress) {
  const wish::Record& wanted = subject.wanted;
  const Scene& scene = subject.patient->scene;
  const Motion motion = seen_motion(subject);
  const int frames =
      std::max(1, static_cast<int>(std::lround(motion.duration_s * wanted.frames_per_second)) + 1);
  report(progress, "preparing the recording", 0);
  SimulatorSettings recorded = settings;
  recorded.face = true;
  // The recorder first: a folder that cannot be written ends it at once.
  Recorder recorder({.folder = wanted.folder,
                     .width = wanted.width,
                     .height = wanted.height,
                     .frames = frames,
                     .frames_per_second = wanted.frames_per_second,
                     .film = wanted.film,
                     .resume = false,
                     .identity = {{"condyle", CONDYLE_VERSION},
                                  {"case", scene.patient.name},
                                  {"motion", motion.name},
                                  {"camera", "the window's"}}});
  ViewDrawing drawing(subject, settings);
  Motion as_played = motion;
  as_played.recorded = !subject.view.obey_contact;  // then contact alters nothing
  Playback playback(scene, as_played, recorded, false, free_poses(subject));
  for (int i = 0; i < frames; ++i) {
    const double share = frames > 1 ? static_cast<double>(i) / (frames - 1) : 0;
    report(progress, fmt::format("picture {} of {}", i + 1, frames), share);
    const FrameState frame = playback.at(motion.duration_s * share);
    recorder.add(i, drawing.picture(frame, wanted.turntable
                                               ? turned(wanted.camera, 2 * std::numbers::pi * share)
                                               : wanted.camera));
  }
  report(progress, wanted.film ? "making the film" : "writing the last pictures", 1);
  recorder.finish();
  return wanted.film ? recorder.film_file() : wanted.folder;
}

}  // namespace condyle
