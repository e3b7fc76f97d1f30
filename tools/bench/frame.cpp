#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "engine/mesh/refine.h"
#include "render/gl/gl_context.h"
#include "render/scene/scene_renderer.h"
#include "sim/report/report.h"
#include "sim/simulator/live.h"
#include "tools/bench/window.h"
#include "tools/bench/bench.h"
#include "tools/common.h"

namespace condyle {
namespace {

/// As many triangles as a displayed face is meant to have at most, about.
constexpr int dense_triangles = 200000;

/// The patient's tissue under the same face in smaller triangles; null without a face.
std::shared_ptr<const TissueModel> dense_face(const Case& patient, const TissueSettings& settings,
                                              std::size_t& triangles) {
  Case dense = patient;
  for (auto& part : dense.parts) {
    if (part.role != Role::face || part.mesh.empty()) continue;
    for (double edge_mm = 8; part.mesh.triangles.size() < dense_triangles; edge_mm *= 0.85) {
      const std::vector<double> edges(part.mesh.vertices.size(), edge_mm);
      part.mesh = refine(std::move(part.mesh), edges);
    }
    triangles = part.mesh.triangles.size();
  }
  return build_tissue(dense, settings);
}

/// How far all nodes but a hundredth are from where they should be, mm.
double usual_error(const TissueState& is, const TissueState& should) {
  std::vector<double> distance;
  for (std::size_t i = 0; i < is.nodes.size(); ++i)
    distance.push_back((is.nodes[i] - should.nodes[i]).norm());
  if (distance.empty()) return 0;
  const auto place = distance.begin() + static_cast<std::ptrdiff_t>(distance.size() * 99 / 100);
  std::nth_element(distance.begin(), place, distance.end());
  return *place;
}

double simulation_ms(const FrameState& frame) {
  return frame.times[Stage::motion] + frame.times[Stage::contact] + frame.times[Stage::tissue];
}

/// Of a rate the slow end matters.
double fifth_percentile(std::vector<double> rates) {
  for (double& rate : rates) rate = -rate;
  return -summarise(std::move(rates)).p95;
}

}  // namespace

int run_bench_frame(const BenchOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  SimulatorSettings settings;
  settings.face = true;
  settings.threads = common.threads;
  const Scene scene =
      make_scene(open_patient(options.patient, common, bar), settings, bar.callback());
  const Motion motion = make_motion("opening", scene.patient, scene.contacts);
  const int steps = static_cast<int>(std::lround(motion.duration_s / settings.step_s));

  OffscreenContext context;
  SceneRenderer renderer(scene.patient.parts);
  PictureSettings sampled;
  sampled.width = 1920;
  sampled.height = 1080;
  auto smoothed = sampled;
  smoothed.samples = 1;
  smoothed.smooth_edges = true;
  auto moving = smoothed;  // as the window draws while it plays
  moving.shadows = false;
  moving.coarse = true;
  const std::pair<const char*, PictureSettings> pictures[] = {{"frame.render_moving", moving},
                                                              {"frame.render_fxaa", smoothed},
                                                              {"frame.render_msaa", sampled}};
  const auto [low, high] = renderer.bounds();
  const Camera camera = standard_camera("three-quarter", low, high,
                                        static_cast<double>(sampled.width) / sampled.height);
  constexpr int picture_every =
      24;  // pictures are slow without a GPU; simulation is what is measured

  std::size_t face_triangles = 0;
  const auto dense =
      scene.tissue ? dense_face(scene.patient, settings.tissue_model, face_triangles) : nullptr;
  // Another face has another mesh: it is carried by its own.
  const TissueState dense_tissue = dense ? rest_tissue(*dense) : TissueState{};
  std::vector<Eigen::Vector3f> dense_vertices;

  // As a film of the motion shows it.
  constexpr int film_frames = 16;
  std::vector<FrameState> of_film;
  std::map<std::string, std::vector<double>> samples;
  SimulatorSettings live = live_settings(settings);
  live.face = false;
  BenchRow live_error{"frame.live_error", "mm", {}, {}};
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    Playback playback(scene, motion, settings);
    std::vector<TissueState> converged;  // of every step, when the window's are compared
    for (int i = 0; i <= steps; ++i) {
      FrameState frame = playback.at(i * settings.step_s);
      converged.push_back(frame.tissue);
      if (repeat == 0 && i % std::max(1, steps / film_frames) == 0 && of_film.size() < film_frames)
        of_film.push_back(frame);
      samples["frame.motion"].push_back(frame.times[Stage::motion]);
      samples["frame.contact"].push_back(frame.times[Stage::contact]);
      samples["frame.tissue"].push_back(frame.times[Stage::tissue]);
      samples["frame.face"].push_back(frame.times[Stage::face]);
      samples["frame.total"].push_back(simulation_ms(frame));
      if (dense) {
        StageTimes dense_times;
        {
          const StageTimer timer(dense_times, Stage::face);
          deform_face(*dense, dense_tissue, dense_vertices, settings.threads);
        }
        samples["frame.face_dense"].push_back(dense_times[Stage::face]);
      }
      if (i % picture_every == 0)
        for (const auto& [name, kind] : pictures) {
          StageTimes times;
          {
            const StageTimer timer(times, Stage::render);
            renderer.update(frame);
            renderer.picture(camera, kind);
          }
          samples[name].push_back(times[Stage::render]);
        }
      bar.show("measuring", (repeat + (i + 1.0) / (steps + 1)) / options.repeats);
    }
    Playback quick(scene, motion, live);
    const int stride = static_cast<int>(std::lround(live.step_s / settings.step_s));
    for (int i = 0; i <= steps; i += stride) {
      const FrameState as_shown = quick.at(i * settings.step_s);
      samples["frame.live_step"].push_back(simulation_ms(as_shown));
      if (scene.tissue)
        live_error.samples.push_back(
            usual_error(as_shown.tissue, converged[static_cast<std::size_t>(i)]));
    }
  }
  bar.show("recording", 1);
  std::vector<BenchRow> rows = bench_film(scene.patient.parts, of_film, camera, smoothed, sampled);
  rows.push_back(std::move(live_error));
  bar.show("playing as the window does", 1);
  for (BenchRow& row : bench_window(scene, motion, settings, camera))
    rows.push_back(std::move(row));
  bar.clear();

  std::size_t bone_triangles = 0;
  for (const auto& part : scene.patient.parts)
    if (part.role == Role::skull || part.role == Role::mandible)
      bone_triangles = std::max(bone_triangles, part.mesh.triangles.size());
  const int nodes = scene.tissue ? summary(*scene.tissue).nodes : 0;
  nlohmann::ordered_json json;
  json["machine"] = {{"processor", processor()},
                     {"cores", std::thread::hardware_concurrency()},
                     {"opengl", context.description()}};
  for (const char* name : {"frame.motion", "frame.contact", "frame.tissue", "frame.face",
                           "frame.face_dense", "frame.total", "frame.live_step",
                           "frame.render_moving", "frame.render_fxaa", "frame.render_msaa"}) {
    if (samples[name].empty()) continue;
    const auto times = summarise(samples[name]);
    json["results"].push_back({{"name", name},
                               {"median", times.median},
                               {"p95", times.p95},
                               {"unit", "ms"},
                               {"samples", samples[name].size()},
                               {"threads", common.threads},
                               {"nodes", nodes},
                               {"triangles", bone_triangles}});
  }
  for (const BenchRow& row : rows) {
    if (row.samples.empty()) continue;
    const bool rate = row.unit.ends_with("/s");
    const auto measured = summarise(row.samples);
    nlohmann::ordered_json one = {{"name", row.name},
                                  {"median", measured.median},
                                  rate ? nlohmann::ordered_json{"p5", fifth_percentile(row.samples)}
                                       : nlohmann::ordered_json{"p95", measured.p95},
                                  {"unit", row.unit},
                                  {"samples", row.samples.size()},
                                  {"threads", common.threads}};
    for (const auto& [name, value] : row.parameters) one[name] = value;
    json["results"].push_back(std::move(one));
  }
  if (common.json)
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  if (!common.quiet) {
    fmt::print(
        stderr,
        "{}; {} tissue nodes, largest bone {} triangles, {} threads; frame.total is motion + "
        "contact + tissue; frame.live_step: the same as a playing window steps, in steps of {:.1f} "
        "ms and few iterations, and frame.live_error how far all nodes but a hundredth then are "
        "from the converged ones; frame.face_dense carries {} triangles of the face; frame.render "
        "is "
        "a picture of 1920x1080 with shadows, edges smoothed (fxaa) or sampled four times (msaa), "
        "on {}; frame.record: pictures drawn and written, of frames simulated before, with fxaa "
        "and (record_msaa) with msaa; frame.record_with_film: a recording with a film against one "
        "without; frame.window: "
        "pictures and steps a second while the motion plays in a window of that size\n",
        "median and 95th percentile (of what is counted a second: 5th)", nodes, bone_triangles,
        common.threads, 1000 * live.step_s, face_triangles, context.description());
    for (const auto& result : json["results"])
      fmt::print(stderr, "  {:<28}{:>9.3f}{:>9.3f} {}\n", result["name"].get<std::string>(),
                 result["median"].get<double>(),
                 result[result.contains("p5") ? "p5" : "p95"].get<double>(),
                 result["unit"].get<std::string>());
  }
  return 0;
}

}  // namespace condyle
