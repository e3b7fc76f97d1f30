#include "tools/demo/played_motion.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/output/recorder.h"
#include "render/scene/scene_renderer.h"

namespace condyle {

std::size_t PlayedMotion::widest() const {
  const auto found =
      std::max_element(frames.begin(), frames.end(), [](const FrameState& a, const FrameState& b) {
        return a.measures.opening_mm < b.measures.opening_mm;
      });
  return static_cast<std::size_t>(found - frames.begin());
}

PlayedMotion play_motion(const Scene& scene, const Motion& motion,
                         const SimulatorSettings& settings, const PlaySettings& play, bool draws,
                         const Progress& progress) {
  PlayedMotion played;
  played.frames_per_second = (play.frames - 1) / std::max(motion.duration_s, 1e-3);
  std::optional<SceneRenderer> renderer;
  PictureSettings picture;
  picture.width = play.width;
  picture.height = play.height;
  picture.skin_opacity = play.skin_opacity;
  picture.contacts = false;
  Camera camera;
  if (draws) {
    renderer.emplace(scene.patient.parts);
    const auto [low, high] = renderer->bounds();
    camera = standard_camera(play.view, low, high, static_cast<double>(play.width) / play.height);
  }
  Playback playback(scene, motion, settings);
  for (int i = 0; i < play.frames; ++i) {
    const double done = static_cast<double>(i) / (play.frames - 1);
    report(progress, fmt::format("{}: frame {} of {}", scene.patient.name, i + 1, play.frames),
           done);
    FrameState frame = playback.at(motion.duration_s * done);
    if (scene.tissue) {
      played.unconverged += !frame.tissue.converged;
      played.inverted += frame.tissue.inverted_prisms > 0;
    }
    if (renderer) {
      renderer->update(frame);
      played.pictures.push_back(renderer->picture(camera, picture));
    }
    played.frames.push_back(std::move(frame));
  }
  return played;
}

void write_film(const std::filesystem::path& folder, const std::vector<Image>& pictures,
                double frames_per_second, const std::string& identity) {
  Recorder recorder({.folder = folder,
                     .width = pictures.front().width,
                     .height = pictures.front().height,
                     .frames = static_cast<int>(pictures.size()),
                     .frames_per_second = frames_per_second,
                     .film = true,
                     .identity = {{"demo", identity}}});
  for (std::size_t i = 0; i < pictures.size(); ++i) recorder.add(static_cast<int>(i), pictures[i]);
  recorder.finish();
}

}  // namespace condyle
