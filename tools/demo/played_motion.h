#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/image/image.h"
#include "sim/report/motion_series.h"

namespace condyle {

/// A motion that was simulated and drawn at equal steps of time, both ends included.
struct PlayedMotion {
  std::vector<Image> pictures;
  std::vector<FrameState> frames;
  double frames_per_second = 30;
  int unconverged = 0, inverted = 0;  // frames

  /// The frame of largest opening.
  std::size_t widest() const;
};

struct PlaySettings {
  int frames = 45;
  std::string view = "three-quarter";
  double skin_opacity = 0.35;
  int width = 640, height = 720;
};

/// Needs a current OpenGL context where `draws`.
PlayedMotion play_motion(const Scene& scene, const Motion& motion,
                         const SimulatorSettings& settings, const PlaySettings& play, bool draws,
                         const Progress& progress);

/// Writes pictures as folder/frames/*.png and folder/film.mp4.
void write_film(const std::filesystem::path& folder, const std::vector<Image>& pictures,
                double frames_per_second, const std::string& identity);

}  // namespace condyle
