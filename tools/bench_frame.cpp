#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "render/gl_context.h"
#include "render/scene_renderer.h"
#include "sim/report/report.h"
#include "tools/common.h"

namespace condyle {
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
  PictureSettings picture;
  const auto [low, high] = renderer.bounds();
  const Camera camera = standard_camera("three-quarter", low, high,
                                        static_cast<double>(picture.width) / picture.height);
  constexpr int picture_every =
      12;  // pictures are slow without a GPU; simulation is what is measured

  std::map<std::string, std::vector<double>> samples;
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    Playback playback(scene, motion, settings);
    for (int i = 0; i <= steps; ++i) {
      FrameState frame = playback.at(i * settings.step_s);
      const double simulation =
          frame.times[Stage::motion] + frame.times[Stage::contact] + frame.times[Stage::tissue];
      samples["frame.motion"].push_back(frame.times[Stage::motion]);
      samples["frame.contact"].push_back(frame.times[Stage::contact]);
      samples["frame.tissue"].push_back(frame.times[Stage::tissue]);
      samples["frame.face"].push_back(frame.times[Stage::face]);
      samples["frame.total"].push_back(simulation);
      if (i % picture_every == 0) {
        const StageTimer timer(frame.times, Stage::render);
        renderer.update(frame);
        renderer.picture(camera, picture);
      }
      if (i % picture_every == 0) samples["frame.render"].push_back(frame.times[Stage::render]);
      bar.show("measuring", (repeat + (i + 1.0) / (steps + 1)) / options.repeats);
    }
  }
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
                           "frame.total", "frame.render"}) {
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
  if (common.json)
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  if (!common.quiet) {
    fmt::print(
        stderr,
        "{} ms; {} tissue nodes, largest bone {} triangles, {} threads; frame.total is motion + "
        "contact + tissue; frame.render is 1280x720 with 4x multisampling and shadows on {}\n",
        "median and 95th percentile in", nodes, bone_triangles, common.threads,
        context.description());
    for (const auto& result : json["results"])
      fmt::print(stderr, "  {:<14}{:>9.3f}{:>9.3f}\n", result["name"].get<std::string>(),
                 result["median"].get<double>(), result["p95"].get<double>());
  }
  return 0;
}

}  // namespace condyle
