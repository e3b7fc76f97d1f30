#include "tools/view_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/colour_map.h"
#include "tools/picture_taker.h"
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

/// What a command line would say, from what the window shows and its panel asks for.
PicturePlan plan_of(const ViewRecording& subject) {
  const wish::Record& wanted = subject.wanted;
  const Look& look = subject.view.look;
  check_cameras(wanted.cameras);
  caption_lines(wanted.caption, 0, {}, "");
  PicturePlan plan;
  plan.annotations = {.scale_bar = look.scale_bar, .letters = look.letters, .caption = {}};
  plan.near_mm = DistanceBands{}.near_mm;
  plan.caption = wanted.caption;
  plan.cameras = wanted.cameras;
  plan.window =
      WindowPicture{.camera = wanted.camera, .upright = wanted.upright, .before = wanted.kept};
  plan.window->overlays = [&subject](const FrameState& frame) {
    return view_overlays(*subject.patient, subject.motion->motion, frame, subject.view,
                         subject.paths);
  };
  if (look.wipe) plan.wipe = look.wipe_at;
  if (subject.view.distances) plan.map = SurfaceMap::distance;
  if (look.displacement) plan.map = SurfaceMap::displacement;
  PictureSettings& settings = plan.settings;
  settings = wanted.picture;
  settings.width = wanted.width;
  settings.height = wanted.height;
  settings.samples = wanted.edges == RecordEdges::msaa ? 4 : 1;
  settings.smooth_edges = wanted.edges == RecordEdges::fxaa;
  settings.supersampling = wanted.supersampling;
  settings.transparent = wanted.transparent;
  plan.annotations.backdrop = settings.backdrop;
  plan.words = {{"picture", "as in the window"}};
  return plan;
}

}  // namespace

std::string record_view(const ViewRecording& subject, const SimulatorSettings& settings,
                        const Progress& progress) {
  const wish::Record& wanted = subject.wanted;
  const Scene& scene = subject.patient->scene;
  const Motion motion = seen_motion(subject);
  const int frames =
      std::max(1, static_cast<int>(std::lround(motion.duration_s * wanted.frames_per_second)) + 1);
  report(progress, "preparing the recording", 0);
  SimulatorSettings recorded = settings;
  recorded.face = true;
  // The pictures' folders first: one that cannot be written ends it at once.
  PictureTaker pictures(
      plan_of(subject), {.out = wanted.folder, .film = wanted.film},
      {.scene = scene,
       .motion = motion,
       .settings = recorded,
       .frames = frames,
       .frames_per_second = wanted.frames_per_second,
       .identity = {
           {"condyle", CONDYLE_VERSION}, {"case", scene.patient.name}, {"motion", motion.name}}});
  Motion as_played = motion;
  as_played.recorded = !subject.view.obey_contact;  // then contact alters nothing
  Playback playback(scene, as_played, recorded, false, free_poses(subject));
  for (int i = 0; i < frames; ++i) {
    const double share = frames > 1 ? static_cast<double>(i) / (frames - 1) : 0;
    report(progress, fmt::format("picture {} of {}", i + 1, frames), share);
    pictures.take(i, playback.at(motion.duration_s * share), [](int, const FrameState&) {});
  }
  report(progress, wanted.film ? "making the film" : "writing the last pictures", 1);
  pictures.finish();
  const bool one_film = wanted.film && wanted.cameras.size() == 1;
  const auto made = one_film ? wanted.folder / "film.mp4" : wanted.folder;
  const std::string lacks = pictures.facts().shortfall();
  return "Recorded " + made.string() + (lacks.empty() ? "" : " (" + lacks + ")");
}

}  // namespace condyle
