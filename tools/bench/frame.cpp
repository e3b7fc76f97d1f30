#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "engine/mesh/refine.h"
#include "render/gl/gl_context.h"
#include "render/scene/scene_renderer.h"
#include "sim/report/report.h"
#include "sim/simulator/live.h"
#include "tools/bench/bench.h"
#include "tools/bench/window.h"
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

/// The opening of one patient, measured: what the stages of its frames, their pictures and a
/// playing window take.
class FrameBench {
 public:
  FrameBench(const BenchOptions& options, const CommonOptions& common)
      : options_(options),
        common_(common),
        bar_(common),
        settings_(with_face(common.threads)),
        live_(live_settings(settings_)),
        scene_(make_scene(open_patient(options.patient, common, bar_), settings_, bar_.callback())),
        motion_(make_motion("opening", scene_.patient, scene_.contacts)),
        steps_(static_cast<int>(std::lround(motion_.duration_s / settings_.step_s))),
        opengl_(context_->description()),
        renderer_(scene_.patient.parts) {
    live_.face = false;
    sampled_.width = 1920;
    sampled_.height = 1080;
    smoothed_ = sampled_;
    smoothed_.samples = 1;
    smoothed_.smooth_edges = true;
    moving_ = smoothed_;
    moving_.shadows = false;
    moving_.coarse = true;
    const auto [low, high] = renderer_->bounds();
    camera_ = standard_camera("three-quarter", low, high,
                              static_cast<double>(sampled_.width) / sampled_.height);
    if (!scene_.tissue) return;
    dense_ = dense_face(scene_.patient, settings_.tissue_model, face_triangles_);
    if (dense_) dense_tissue_ = rest_tissue(*dense_);
  }

  void measure() {
    BenchRow live_error{"frame.live_error", "mm", {}, {}};
    for (int repeat = 0; repeat < options_.repeats; ++repeat) play_live(play(repeat), live_error);
    // The recording draws with contexts of its own.
    renderer_.reset();
    context_.reset();
    bar_.show("recording", 1);
    rows_ = bench_film(scene_.patient.parts, of_film_, camera_, smoothed_, sampled_);
    rows_.push_back(std::move(live_error));
    bar_.show("playing as the window does", 1);
    for (BenchRow& row : bench_window(scene_, motion_, settings_, camera_))
      rows_.push_back(std::move(row));
    bar_.clear();
  }

  nlohmann::ordered_json json() const {
    nlohmann::ordered_json json;
    json["machine"] = {{"processor", processor()},
                       {"cores", std::thread::hardware_concurrency()},
                       {"opengl", opengl_}};
    json["results"] = nlohmann::ordered_json::array();
    for (const char* name : {"frame.motion", "frame.contact", "frame.tissue", "frame.face",
                             "frame.face_dense", "frame.total", "frame.live_step",
                             "frame.render_moving", "frame.render_fxaa", "frame.render_msaa"}) {
      const auto measured = samples_.find(name);
      if (measured == samples_.end()) continue;
      const auto times = summarise(measured->second);
      json["results"].push_back({{"name", name},
                                 {"median", times.median},
                                 {"p95", times.p95},
                                 {"unit", "ms"},
                                 {"samples", measured->second.size()},
                                 {"threads", common_.threads},
                                 {"nodes", nodes()},
                                 {"triangles", bone_triangles()}});
    }
    for (const BenchRow& row : rows_)
      if (!row.samples.empty()) json["results"].push_back(row_json(row));
    return json;
  }

  void print(const nlohmann::ordered_json& json) const {
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
        "median and 95th percentile (of what is counted a second: 5th)", nodes(), bone_triangles(),
        common_.threads, 1000 * live_.step_s, face_triangles_, opengl_);
    for (const auto& result : json["results"])
      fmt::print(stderr, "  {:<28}{:>9.3f}{:>9.3f} {}\n", result["name"].get<std::string>(),
                 result["median"].get<double>(),
                 result[result.contains("p5") ? "p5" : "p95"].get<double>(),
                 result["unit"].get<std::string>());
  }

 private:
  static constexpr int picture_every = 24;  // frames; pictures are slow without a GPU
  static constexpr int film_frames = 16;

  static SimulatorSettings with_face(int threads) {
    SimulatorSettings settings;
    settings.face = true;
    settings.threads = threads;
    return settings;
  }

  /// One opening as it is recorded. Returns the tissue of every step.
  std::vector<TissueState> play(int repeat) {
    Playback playback(scene_, motion_, settings_);
    std::vector<TissueState> converged;
    for (int i = 0; i <= steps_; ++i) {
      const FrameState frame = playback.at(i * settings_.step_s);
      converged.push_back(frame.tissue);
      if (repeat == 0 && i % std::max(1, steps_ / film_frames) == 0 &&
          of_film_.size() < film_frames)
        of_film_.push_back(frame);
      samples_["frame.motion"].push_back(frame.times[Stage::motion]);
      samples_["frame.contact"].push_back(frame.times[Stage::contact]);
      samples_["frame.tissue"].push_back(frame.times[Stage::tissue]);
      samples_["frame.face"].push_back(frame.times[Stage::face]);
      samples_["frame.total"].push_back(simulation_ms(frame));
      if (dense_) time_dense_face();
      if (i % picture_every == 0) time_pictures(frame);
      bar_.show("measuring", (repeat + (i + 1.0) / (steps_ + 1)) / options_.repeats);
    }
    return converged;
  }

  void time_dense_face() {
    StageTimes times;
    {
      const StageTimer timer(times, Stage::face);
      deform_face(*dense_, dense_tissue_, dense_vertices_, settings_.threads);
    }
    samples_["frame.face_dense"].push_back(times[Stage::face]);
  }

  void time_pictures(const FrameState& frame) {
    for (const auto& [name, kind] :
         {std::pair{"frame.render_moving", &moving_}, std::pair{"frame.render_fxaa", &smoothed_},
          std::pair{"frame.render_msaa", &sampled_}}) {
      StageTimes times;
      {
        const StageTimer timer(times, Stage::render);
        renderer_->update(frame);
        renderer_->picture(camera_, *kind);
      }
      samples_[name].push_back(times[Stage::render]);
    }
  }

  /// One opening in the steps of a playing window, against the converged tissue of every step.
  void play_live(const std::vector<TissueState>& converged, BenchRow& error) {
    Playback quick(scene_, motion_, live_);
    const int stride = static_cast<int>(std::lround(live_.step_s / settings_.step_s));
    for (int i = 0; i <= steps_; i += stride) {
      const FrameState as_shown = quick.at(i * settings_.step_s);
      samples_["frame.live_step"].push_back(simulation_ms(as_shown));
      if (scene_.tissue)
        error.samples.push_back(
            usual_error(as_shown.tissue, converged[static_cast<std::size_t>(i)]));
    }
  }

  std::size_t bone_triangles() const {
    std::size_t largest = 0;
    for (const auto& part : scene_.patient.parts)
      if (part.role == Role::skull || part.role == Role::mandible)
        largest = std::max(largest, part.mesh.triangles.size());
    return largest;
  }

  int nodes() const { return scene_.tissue ? summary(*scene_.tissue).nodes : 0; }

  nlohmann::ordered_json row_json(const BenchRow& row) const {
    const bool rate = row.unit.ends_with("/s");
    const auto measured = summarise(row.samples);
    nlohmann::ordered_json one = {{"name", row.name},
                                  {"median", measured.median},
                                  rate ? nlohmann::ordered_json{"p5", fifth_percentile(row.samples)}
                                       : nlohmann::ordered_json{"p95", measured.p95},
                                  {"unit", row.unit},
                                  {"samples", row.samples.size()},
                                  {"threads", common_.threads}};
    for (const auto& [name, value] : row.parameters) one[name] = value;
    return one;
  }

  const BenchOptions& options_;
  const CommonOptions& common_;
  ProgressBar bar_;
  const SimulatorSettings settings_;
  SimulatorSettings live_;  // of a playing window
  const Scene scene_;
  const Motion motion_;
  const int steps_;
  std::optional<OffscreenContext> context_{std::in_place};
  const std::string opengl_;
  std::optional<SceneRenderer> renderer_;
  PictureSettings sampled_, smoothed_;
  PictureSettings moving_;  // as the window draws while it plays
  Camera camera_;
  std::size_t face_triangles_ = 0;
  // Another face has another mesh: it is carried by its own.
  std::shared_ptr<const TissueModel> dense_;
  TissueState dense_tissue_;
  std::vector<Eigen::Vector3f> dense_vertices_;
  std::vector<FrameState> of_film_;
  std::map<std::string, std::vector<double>> samples_;
  std::vector<BenchRow> rows_;
};

}  // namespace

int run_bench_frame(const BenchOptions& options, const CommonOptions& common) {
  FrameBench bench(options, common);
  bench.measure();
  const nlohmann::ordered_json json = bench.json();
  if (common.json)
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  if (!common.quiet) bench.print(json);
  return 0;
}

}  // namespace condyle
