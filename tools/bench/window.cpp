#include "tools/bench/window.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <thread>

#include "engine/core/error.h"
#include "engine/core/temporary_path.h"
#include "render/output/parallel_renderers.h"
#include "render/output/recorder.h"
#include "render/window/picture/render_thread.h"
#include "render/window/settings/layout.h"
#include "render/window/view/playback.h"
#include "sim/simulator/live.h"

namespace condyle {
namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

std::vector<BenchRow> play(const Scene& scene, const Motion& motion,
                           const SimulatorSettings& settings, const Camera& camera, int width,
                           int height, const std::string& name) {
  constexpr double settle_s = 3, measure_s = 6, span_s = 0.5;
  constexpr std::chrono::milliseconds turn(4);
  LiveSimulation simulation(scene, motion, live_settings(settings));
  RenderThread render_thread([] {});
  QualityGovernor governor;
  RenderRequest order{
      .parts = std::make_shared<DrawnParts>(DrawnParts{scene.patient.parts, {}, {}}),
      .camera = camera};
  order.settings.width = width;
  order.settings.height = height;
  order.moving = true;
  ViewState view;
  view.playing = true;
  BenchRow pictures{name + "_pictures", "1/s", {}, {}}, steps{name + "_steps", "1/s", {}, {}};
  double scale = 1;
  int counted = 0;
  // Timed from the first picture on, after all uploads.
  bool begun = false, due = false;  // due: a frame without a picture request
  Clock::time_point start = Clock::now(), last = start, span = start, ordered{};
  while (!begun || seconds(start, Clock::now()) < settle_s + measure_s) {
    const auto now = Clock::now();
    advance_clock(view, seconds(last, now), motion.duration_s,
                  order.frame ? order.frame->time_s : 0);
    last = now;
    simulation.request({.time_s = view.time_s});
    if (auto frame = simulation.take()) {
      order.frame = std::make_shared<FrameState>(std::move(*frame));
      due = true;
    }
    governor.simulated(simulation.steps_per_second());
    if (due && seconds(ordered, now) >= governor.min_interval_s()) {
      due = false;
      ordered = now;
      order.quality = governor.choose(true);
      ++order.number;
      render_thread.request(order);
    }
    if (const auto picture = render_thread.take()) {
      if (!begun) {
        begun = true;
        start = span = Clock::now();
      } else {
        governor.measured(true, picture->ms);
        ++counted;
        scale = picture->quality.render_scale;
      }
    }
    if (begun && seconds(span, now) >= span_s) {
      if (seconds(start, span) >= settle_s - 1e-3) {
        pictures.samples.push_back(counted / seconds(span, now));
        steps.samples.push_back(simulation.steps_per_second());
      }
      counted = 0;
      span = now;
    }
    std::this_thread::sleep_for(turn);
  }
  for (BenchRow* row : {&pictures, &steps})
    row->parameters = {{"width", width}, {"height", height}, {"render_scale", scale}};
  return {pictures, steps};
}

}  // namespace

std::vector<BenchRow> bench_window(const Scene& scene, const Motion& motion,
                                   const SimulatorSettings& settings, const Camera& camera) {
  constexpr int width = 1920, height = 1080;
  const ViewRect with_panels = lay_out(width, height, 1, true).view;
  std::vector<BenchRow> rows =
      play(scene, motion, settings, camera, static_cast<int>(std::lround(with_panels.width)),
           static_cast<int>(std::lround(with_panels.height)), "frame.window");
  for (auto& row : play(scene, motion, settings, camera, width, height, "frame.whole_window"))
    rows.push_back(std::move(row));
  return rows;
}

std::vector<BenchRow> bench_film(std::span<const Part> parts, const std::vector<FrameState>& frames,
                                 const Camera& camera, const PictureSettings& smoothed,
                                 const PictureSettings& sampled) {
  constexpr int rounds = 5;
  const TemporaryPath folder("bench");
  ParallelRenderers drawers(parts);
  const auto record = [&](const PictureSettings& picture, bool film) {
    const auto start = Clock::now();
    Recorder recorder({.folder = folder.path(),
                       .width = picture.width,
                       .height = picture.height,
                       .frames = static_cast<int>(frames.size()),
                       .film = film,
                       .identity = {}});
    for (std::size_t i = 0; i < frames.size(); ++i)
      drawers.add([&, i](SceneRenderer& renderer, int) {
        renderer.update(frames[i]);
        const auto image = std::make_shared<Image>(renderer.picture(camera, picture));
        return [&recorder, i, image] { recorder.add(static_cast<int>(i), std::move(*image)); };
      });
    drawers.finish();
    recorder.finish();
    return seconds(start, Clock::now()) / static_cast<double>(frames.size());
  };
  BenchRow ratio{"frame.record_with_film", "times as long", {}, {}},
      plain{"frame.record", "pictures/s", {}, {}}, fine{"frame.record_msaa", "pictures/s", {}, {}};
  try {
    record(smoothed, true);  // the first prepares everything
    for (int i = 0; i < rounds; ++i) {
      const double without = record(smoothed, false);
      plain.samples.push_back(1 / without);
      ratio.samples.push_back(record(smoothed, true) / without);
      fine.samples.push_back(1 / record(sampled, false));
    }
  } catch (const MachineError&) {
    return {};  // no ffmpeg, or no space
  }
  for (BenchRow* row : {&plain, &fine, &ratio})
    row->parameters = {{"width", smoothed.width},
                       {"height", smoothed.height},
                       {"pictures", static_cast<double>(frames.size())}};
  return {plain, fine, ratio};
}

}  // namespace condyle
