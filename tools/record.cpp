#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "sim/case/tissue_plan_file.h"
#include "sim/report/motion_plots.h"
#include "sim/report/report.h"
#include "sim/report/trace.h"
#include "tools/common.h"
#include "tools/picture_taker.h"
#include "tools/tissue_options.h"

namespace condyle {
namespace {

/// Times of the frames: the whole motion, first and last included.
struct FrameTimes {
  int count = 1;
  double duration_s = 0;
  double operator[](int i) const { return count == 1 ? 0 : duration_s * i / (count - 1); }
  double fps() const { return count == 1 || duration_s <= 0 ? 30 : (count - 1) / duration_s; }
};

FrameTimes frame_times(const RecordOptions& options, double duration_s) {
  constexpr double most_frames = 1e6;
  const double wanted = std::floor(duration_s * options.fps + 0.5) + 1;
  if (options.frames == 0 && !(wanted <= most_frames))
    throw InputError(fmt::format("--fps {}: makes {} frames of {} s; at most {} are recorded",
                                 options.fps, wanted, duration_s, most_frames));
  return {options.frames > 0 ? options.frames : static_cast<int>(wanted), duration_s};
}

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

std::uint64_t case_hash(const Case& patient) {
  std::uint64_t hash = hash_start;
  for (const auto& part : patient.parts) {
    hash = hash_bytes(part.name.data(), part.name.size(), hash);
    hash = hash_bytes(&part.role, sizeof part.role, hash);
    hash = hash_bytes(&part.carrier, sizeof part.carrier, hash);
    for (const auto& c : part.mesh.colors) hash = hash_bytes(c.data(), 3 * sizeof(float), hash);
    for (const auto& v : part.mesh.vertices) hash = hash_bytes(v.data(), 3 * sizeof(double), hash);
    for (const auto& t : part.mesh.triangles) hash = hash_bytes(t.data(), 3 * sizeof(int), hash);
  }
  for (const auto& [name, point] : patient.landmarks.points)
    hash = hash_bytes(point.data(), 3 * sizeof(double), hash_bytes(name.data(), name.size(), hash));
  for (const auto& rule : patient.pair_rules) {
    const std::string text = fmt::format("{},{},{},{},{}", rule.a, rule.b, policy_name(rule.policy),
                                         rule.gap_mm, rule.margin_mm.value_or(-1));
    hash = hash_bytes(text.data(), text.size(), hash);
  }
  return hash;
}

/// Of every pose that the recording asks for: at the fixed steps and at the frames.
std::uint64_t motion_hash(const Motion& motion, const FrameTimes& times, double step_s) {
  std::uint64_t hash = hash_start;
  const auto add = [&](double time_s) {
    const Pose pose = motion.wanted(time_s);
    hash = hash_bytes(pose.R.coeffs().data(), 4 * sizeof(double), hash);
    hash = hash_bytes(pose.t.data(), 3 * sizeof(double), hash);
  };
  for (int i = 0; i * step_s <= motion.duration_s; ++i) add(i * step_s);
  for (int i = 0; i < times.count; ++i) add(times[i]);
  return hash;
}

std::string contact_text(const MotionOptions& options) {
  std::string text = options.respect_contact ? "respected" : "as the motion wants";
  if (options.friction > 0) text += fmt::format(", friction {}", options.friction);
  for (const auto& pair : options.pairs) text += "; " + pair;
  return text;
}

std::string tissue_text(const MotionOptions& options, const Case& patient) {
  if (!options.tissue) return "none";
  const TissuePlan plan = overlaid(patient.tissue, parse_tissue(options.tissue_model));
  return fmt::format("{} {}", options.surface_nodes, tissue_plan_json(plan).dump());
}

/// The report, with what its pictures were drawn with.
std::string with_pictures(const std::string& report, const PictureFacts& facts) {
  auto json = nlohmann::ordered_json::parse(report);
  json["pictures"] = {
      {"driver", facts.driver}, {"samples_asked", facts.samples_asked}, {"samples", facts.samples}};
  return json.dump(2) + "\n";
}

/// Fails before the long work when the command line is wrong in a way that needs no patient.
void check_early(const RecordOptions& options) {
  if (options.pictures) check_pictures(options.picture);
}

}  // namespace

int run_record(const RecordOptions& options, const CommonOptions& common) {
  check_early(options);
  make_folder(options.out);
  ProgressBar bar(common);
  auto settings = simulator_settings(options.motion, common);
  settings.face = options.pictures;
  const Scene scene =
      make_scene(open_patient(options.motion.patient, common, bar), settings, bar.callback());
  tell_notes(scene, common, bar);
  bar.show("preparing the motion", 0);
  Playback playback(scene, motion_of(options.motion, scene, common.threads), settings,
                    options.motion.respect_contact);
  const Motion& motion = playback.motion();
  const FrameTimes times = frame_times(options, motion.duration_s);

  TraceWriter trace(options.out / "trace.csv", motion.muscle_names);
  MotionReport report(scene, motion, settings);
  std::optional<PictureTaker> pictures;  // ends first: it gives frames to the trace
  if (options.pictures)
    pictures.emplace(
        parse_pictures(options.picture, scene.patient),
        RecordingFiles{.out = options.out, .film = options.film, .resume = options.resume},
        RecordingSubject{
            .scene = scene,
            .motion = motion,
            .settings = settings,
            .frames = times.count,
            .frames_per_second = times.fps(),
            .identity = {{"condyle", CONDYLE_VERSION},
                         {"case", hash_text(case_hash(scene.patient))},
                         {"motion", motion.name + " " +
                                        hash_text(motion_hash(motion, times, settings.step_s))},
                         {"contact", contact_text(options.motion)},
                         {"tissue", tissue_text(options.motion, scene.patient)}}});
  for (int i = 0; i < times.count; ++i) {
    FrameState frame = playback.at(times[i]);
    const auto done = [&](int number, const FrameState& drawn) {
      trace.add(number, drawn);
      report.add(drawn);
    };
    if (pictures)
      pictures->take(i, std::move(frame), done);
    else
      done(i, frame);
    bar.show(fmt::format("frame {} of {}", i + 1, times.count), (i + 1.0) / times.count);
  }
  if (pictures) pictures->wait();
  bar.clear();
  trace.finish();
  std::string json = report.json();
  if (pictures) json = with_pictures(json, pictures->facts());
  write_file(options.out / "report.json", json);
  if (motion.muscles) write_file(options.out / "excitations.csv", excitations_csv(motion));
  if (options.plots) {
    for (const auto& plot : motion_plots(report.series()))
      write_file(options.out / (plot.name + ".svg"), panels_svg(plot.panels));
  }
  if (pictures) pictures->finish();
  if (common.json) fmt::print("{}", json);
  if (!common.quiet) {
    for (const auto& note : motion.notes) fmt::print(stderr, "note: {}\n", note);
    if (const auto lacks = pictures ? pictures->facts().shortfall() : ""; !lacks.empty())
      fmt::print(stderr, "note: {}; --edges fxaa or --supersample 2 smooth them\n", lacks);
    fmt::print(stderr, "{}", report.text());
    if (pictures && pictures->kept() > 0)
      fmt::print(stderr, "{} frames were there already and were kept\n", pictures->kept());
    fmt::print(stderr, "results are in {}\n", options.out.string());
  }
  return 0;
}

}  // namespace condyle
