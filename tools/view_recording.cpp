#include "tools/view_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "render/gl_context.h"
#include "render/recorder.h"
#include "render/scene_renderer.h"
#include "tools/distance_drawing.h"

namespace condyle {

std::filesystem::path record_view(const wish::Record& wanted, const ViewPatient& patient,
                                  const Motion& motion, const SimulatorSettings& settings,
                                  bool obey_contact, const Progress& progress) {
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
                                  {"case", patient.scene.patient.name},
                                  {"motion", motion.name},
                                  {"camera", "the window's"}}});
  const OffscreenContext context;
  const auto& parts = patient.scene.patient.parts;
  SceneRenderer renderer(parts);
  std::optional<DistanceDrawing> distances;
  if (wanted.distances)
    distances.emplace(patient.scene.patient,
                      DistanceMapSettings{.pair_rules = settings.contact.pair_rules},
                      settings.threads, renderer);
  Playback playback(patient.scene, motion, recorded, obey_contact);
  PictureSettings picture = wanted.picture;
  picture.width = wanted.width;
  picture.height = wanted.height;
  picture.samples = 4;
  for (int i = 0; i < frames; ++i) {
    const double share = frames > 1 ? static_cast<double>(i) / (frames - 1) : 0;
    report(progress, fmt::format("picture {} of {}", i + 1, frames), share);
    const FrameState frame = playback.at(motion.duration_s * share);
    renderer.update(frame);
    if (distances) distances->color(renderer, frame);
    Image image = renderer.picture(
        wanted.turntable ? turned(wanted.camera, 2 * std::numbers::pi * share) : wanted.camera,
        picture);
    if (distances) distances->add_legend_to(image);
    recorder.add(i, std::move(image));
  }
  report(progress, wanted.film ? "making the film" : "writing the last pictures", 1);
  recorder.finish();
  return wanted.film ? recorder.film_file() : wanted.folder;
}

}  // namespace condyle
