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

/// Pictures a second and steps of the simulation a second while a motion is played as the window
/// plays it: the simulation and the pictures each on a thread of their own, the governor choosing
/// the quality. One sample each half second, after the governor has found its level. For the view
/// of a window of 1920x1080 with its panels, and for one without.
std::vector<BenchRow> bench_window(const Scene& scene, const Motion& motion,
                                   const SimulatorSettings& settings, const Camera& camera);

/// Recorded pictures a second, with edges smoothed and sampled, and how many times as long it takes
/// with a film as without; empty without ffmpeg. Of the same size.
std::vector<BenchRow> bench_film(std::span<const Part> parts, const std::vector<FrameState>& frames,
                                 const Camera& camera, const PictureSettings& smoothed,
                                 const PictureSettings& sampled);

}  // namespace condyle
