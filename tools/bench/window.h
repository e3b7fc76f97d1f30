#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "render/camera/camera.h"
#include "render/scene/scene_renderer.h"
#include "sim/simulator/simulator.h"

namespace condyle {

/// Measured values of one name.
struct BenchRow {
  std::string name, unit;
  std::vector<double> samples;
  std::map<std::string, double> parameters;
};

/// Pictures and simulation steps per second while a motion is played as in the window: the
/// simulation and the pictures on separate threads, the governor choosing the quality. One sample
/// per half second, after the governor has settled. For the view of a window of 1920x1080 with its
/// panels, and for one without.
std::vector<BenchRow> bench_window(const Scene& scene, const Motion& motion,
                                   const SimulatorSettings& settings, const Camera& camera);

/// Recorded pictures per second, with edges smoothed and sampled, and the ratio of the times with
/// and without a film; empty without ffmpeg. Same picture size.
std::vector<BenchRow> bench_film(std::span<const Part> parts, const std::vector<FrameState>& frames,
                                 const Camera& camera, const PictureSettings& smoothed,
                                 const PictureSettings& sampled);

}  // namespace condyle
