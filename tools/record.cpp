#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "sim/report/motion_plots.h"
#include "sim/report/report.h"
#include "sim/report/trace.h"
#include "tools/common.h"
#include "tools/interruption.h"
#include "tools/picture_taker.h"
#include "tools/recording_identity.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

/// Times of the frames: the whole motion, first and last included.
struct FrameTimes {
  int count = 1;
  double duration_s = 0;
  double operator[](int i) const { return count == 1 ? 0 : duration_s * i / (count - 1); }
  std::vector<double> all() const {
    std::vector<double> times;
    for (int i = 0; i < count; ++i) times.push_back((*this)[i]);
    return times;
  }
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
        RecordingSubject{.scene = scene,
                         .motion = motion,
                         .settings = settings,
                         .frames = times.count,
                         .frames_per_second = times.fps(),
                         .identity = recording_identity(scene, motion, times.all(), settings.step_s,
                                                        options.motion)});
  std::optional<Interruption> interruption;
  if (options.pictures)
    interruption.emplace("condyle: interrupted; the pictures made so far stay in " +
                         fs::absolute(options.out).lexically_normal().string() +
                         ", and the same command with --resume makes the others");
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
