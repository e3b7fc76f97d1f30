#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "render/recording/frame_renderer.h"
#include "render/recording/recording_identity.h"
#include "render/scene/face_shape.h"
#include "sim/operated/state_before.h"
#include "sim/report/expression_report.h"
#include "sim/report/motion_plots.h"
#include "sim/report/report.h"
#include "sim/report/trace.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/interruption.h"
#include "tools/motion_options.h"
#include "tools/picture_options.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

struct RecordOptions {
  MotionOptions motion;
  fs::path out;
  int frames = 0;  // 0 = duration x fps
  double fps = 30;
  bool plots = false;
  bool pictures = false;  // `run` has none
  PictureOptions picture = {};
  bool film = false;
  bool resume = false;
  std::vector<std::string> also = {};  // FOLDER=PARTS
};

/// Times of the frames over the whole motion, both ends included.
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
  constexpr double max_frames = 1e6;
  const double rounded = std::floor(duration_s * options.fps + 0.5) + 1;
  if (options.frames == 0 && !(rounded <= max_frames))
    throw InputError(fmt::format("--fps {}: makes {} frames of {} s; at most {} are recorded",
                                 options.fps, rounded, duration_s, max_frames));
  return {options.frames > 0 ? options.frames : static_cast<int>(rounded), duration_s};
}

/// Notes on what is for looks alone; empty: none.
struct LookNotes {
  std::string life, lids;
};

LookNotes look_notes(const std::optional<PicturePlan>& plan, const Case& patient, bool lids_move) {
  if (!plan) return {};
  return {.life = plan->settings.life ? life_note(patient.parts, plan->settings) : "",
          .lids = lids_move ? lids_note(patient.parts) : ""};
}

/// The report with the metadata of its pictures.
std::string with_pictures(const std::string& report, const RenderMetadata& facts,
                          const LookNotes& notes) {
  auto json = nlohmann::ordered_json::parse(report);
  json["pictures"] = {
      {"driver", facts.driver}, {"samples_asked", facts.samples_asked}, {"samples", facts.samples}};
  if (!notes.life.empty()) json["pictures"]["life"] = notes.life;
  if (!notes.lids.empty()) json["pictures"]["lids"] = notes.lids;
  return json.dump(2) + "\n";
}

/// The same expression before the operation at the time of the report; none without a plan, nor
/// where an option needs the operated patient: `why` says so.
std::optional<ExpressionMeasures> expression_before(const RecordOptions& options, const Case& uncut,
                                                    const MotionReport& report,
                                                    SimulatorSettings settings, ProgressBar& bar,
                                                    std::string& why) try {
  if (options.motion.plan.empty() || report.expression().findings.empty()) return std::nullopt;
  settings.face = false;
  const Scene before = make_scene(uncut, settings, bar.callback());
  bar.show("the expression before the operation", 0.9);
  Playback playback(before, motion_of(options.motion, before, settings.threads), settings,
                    options.motion.respect_contact);
  const double time_s = std::min(report.expression_time_s(), playback.motion().duration_s);
  return expression_measures(before, playback.at(time_s).tissue);
} catch (const InputError& error) {
  why = std::string("the expression before the operation was not measured: ") + error.what();
  return std::nullopt;
}

/// Writes expression.csv, and puts the state before into the report.
std::string with_expression(const std::string& report, const fs::path& folder,
                            const ExpressionMeasures& measures, const ExpressionMeasures* before) {
  write_file(folder / "expression.csv", expression_csv(measures, before));
  auto json = nlohmann::ordered_json::parse(report);
  json["expression"] = expression_json(measures, before);
  return json.dump(2) + "\n";
}

/// A folder and what is shown in its pictures, of FOLDER=PARTS. throws: InputError.
std::pair<fs::path, std::string> folder_and_parts(const std::string& text) {
  const auto equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw InputError("--also " + text +
                     ": must be FOLDER=PARTS, e.g. out/glass=bones,teeth,skin:0.3");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

/// Checks the command line as far as possible without a patient.
void check_early(const RecordOptions& options) {
  check_motion(options.motion);
  if (options.pictures) check_pictures(options.picture);
  const auto absolute = [](const fs::path& folder) {
    return fs::absolute(folder / "").lexically_normal();
  };
  std::set<fs::path> used{absolute(options.out)};
  for (const auto& text : options.also)
    if (!used.insert(absolute(folder_and_parts(text).first)).second)
      throw InputError("--also " + text + ": another recording of this command has that folder");
}

/// The looks of --also. throws: InputError.
std::vector<OtherLook> other_looks(const RecordOptions& options, const PicturePlan& plan,
                                   const Case& patient) {
  std::vector<OtherLook> looks;
  for (const auto& text : options.also) {
    PictureOptions picture = options.picture;
    picture.shown_by = "--also";
    fs::path folder;
    std::tie(folder, picture.show) = folder_and_parts(text);
    PicturePlan look = parse_pictures(picture, patient);
    if (look.map != plan.map)
      throw InputError("--also " + text +
                       ": must ask for the same map as --show: distance, displacement or none");
    looks.push_back({folder, std::move(look.settings), std::move(look.words)});
  }
  return looks;
}

/// The pictures of --show, and those of --also. throws: InputError.
std::pair<PicturePlan, std::vector<OtherLook>> planned_pictures(const RecordOptions& options,
                                                                const Case& patient) {
  PicturePlan plan = parse_pictures(options.picture, patient);
  std::vector<OtherLook> looks = other_looks(options, plan, patient);
  return {std::move(plan), std::move(looks)};
}

/// The folders of --out and --also, one after the other.
std::string folders_of(const RecordOptions& options, bool absolute = false) {
  const auto written = [&](const fs::path& folder) {
    return (absolute ? fs::absolute(folder).lexically_normal() : folder).string();
  };
  std::string list = written(options.out);
  for (const auto& text : options.also) list += " and " + written(folder_and_parts(text).first);
  return list;
}

/// What an interruption says.
std::string pictures_stay(const RecordOptions& options) {
  return "condyle: interrupted; the finished pictures stay in " + folders_of(options, true) +
         ", and the same command with --resume draws the others";
}

/// Left of a wipe is the patient before the operation, if there is one.
void add_state_before(const Case& uncut, const Scene& scene, const MotionOptions& options,
                      PicturePlan& pictures) {
  const auto plan = plan_of(options.plan);
  if (!plan) return;
  FrameState at_rest = rest_frame(scene);
  carry_face(scene, at_rest);
  auto before = before_operation(apply_plan(uncut, *plan), at_rest, uncut);
  if (!before) return;
  pictures.operation = std::make_shared<const BeforeOperation>(std::move(*before));
  pictures.before = {pictures.operation, &pictures.operation->frame};
}

/// What is noted of a finished recording. not_before: see expression_before().
void print_closing_notes(const Motion& motion, const LookNotes& looks,
                         const std::string& not_before,
                         const std::optional<FrameRenderer>& pictures) {
  for (const auto& note : motion.notes) fmt::print(stderr, "note: {}\n", note);
  for (const std::string& note : {looks.life, looks.lids, not_before})
    if (!note.empty()) fmt::print(stderr, "note: {}\n", note);
  if (const auto lacks = pictures ? pictures->facts().shortfall() : ""; !lacks.empty())
    fmt::print(stderr, "note: {}; --edges fxaa or --supersample 2 smooth them\n", lacks);
}

int run_record(const RecordOptions& options, const CommonOptions& common) {
  check_early(options);
  make_folder(options.out);
  ProgressBar bar(common);
  auto settings = simulator_settings(options.motion, common);
  settings.face = options.pictures;
  Case patient = open_patient(case_of(options.motion), common, bar);
  check_motion(options.motion, patient);
  std::optional<PicturePlan> plan;
  const bool is_uncut = options.motion.plan.empty();  // else segments may be named
  std::vector<OtherLook> looks;
  if (options.pictures && is_uncut) std::tie(plan, looks) = planned_pictures(options, patient);
  const Scene scene = scene_of(options.motion, patient, settings, bar.callback());
  if (options.pictures && !is_uncut) {
    std::tie(plan, looks) = planned_pictures(options, scene.patient);
    if (plan->wipe) add_state_before(patient, scene, options.motion, *plan);
  }
  print_notes(scene, options.motion.patient, common, bar);
  bar.show("preparing the motion", 0);
  Playback playback(scene, motion_of(options.motion, scene, common.threads), settings,
                    options.motion.respect_contact);
  const Motion& motion = playback.motion();
  const FrameTimes times = frame_times(options, motion.duration_s);
  if (plan && plan->settings.life) plan->settings.life->lids = motion.lid_strength;
  for (OtherLook& look : looks)
    if (look.settings.life) look.settings.life->lids = motion.lid_strength;

  TraceWriter trace(options.out / "trace.csv", motion.muscle_names, scene.patient.bodies,
                    scene.patient.jaw);
  MotionReport report(scene, motion, settings);
  std::optional<FrameRenderer> pictures;  // destroyed first: it passes frames to the trace
  if (options.pictures)
    pictures.emplace(
        *plan,
        RecordingFiles{.out = options.out,
                       .film = options.film,
                       .resume = options.resume,
                       .others = std::move(looks)},
        RecordingSubject{.scene = scene,
                         .motion = motion,
                         .settings = settings,
                         .frames = times.count,
                         .frames_per_second = times.fps(),
                         .identity = recording_identity(scene, motion, times.all(), settings,
                                                        options.motion.respect_contact)});
  std::optional<Interruption> interruption;
  if (options.pictures) interruption.emplace(pictures_stay(options));
  bool lids_move = false;
  for (int i = 0; i < times.count; ++i) {
    FrameState frame = playback.at(times[i]);
    lids_move |= frame.lids.any();
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
  std::string not_before;
  const auto before = expression_before(options, patient, report, settings, bar, not_before);
  bar.clear();
  trace.finish();
  std::string json = report.json();
  const ExpressionMeasures expression = report.expression();
  if (!expression.findings.empty())
    json = with_expression(json, options.out, expression, before ? &*before : nullptr);
  const LookNotes looks_alone = look_notes(plan, scene.patient, lids_move);
  if (pictures) json = with_pictures(json, pictures->facts(), looks_alone);
  write_file(options.out / "report.json", json);
  if (motion.muscles) write_file(options.out / "excitations.csv", excitations_csv(motion));
  if (options.plots) {
    for (const auto& plot : motion_plots(report.series()))
      write_file(options.out / (plot.name + ".svg"), panels_svg(plot.panels));
  }
  if (pictures) pictures->finish();
  if (common.json) fmt::print("{}", json);
  if (common.prints_summary()) {
    print_closing_notes(motion, looks_alone, not_before, pictures);
    fmt::print(stderr, "{}{}", report.text(),
               expression_text(expression, before ? &*before : nullptr));
    if (pictures && pictures->kept() > 0)
      fmt::print(stderr, "{} frames were there already and were kept\n", pictures->kept());
    fmt::print(stderr, "results are in {}\n", folders_of(options));
  }
  return 0;
}

/// Options of `record` and `run`; the latter has none for pictures.
CLI::App& add_recording(Commands& commands, const char* name, const char* what, const char* example,
                        const std::shared_ptr<RecordOptions>& options) {
  CLI::App& command = commands.add(name, what, example, [options](const CommonOptions& common) {
    return run_record(*options, common);
  });
  add_motion(command, options->motion);
  add_expression(command, options->motion);
  command.add_option("--out", options->out, "Folder for the results")
      ->type_name("FOLDER")
      ->required();
  in_range(command.add_option("--frames", options->frames,
                              "The whole motion in this many frames, both ends included"),
           1, 1000000);
  in_range(command.add_option("--fps", options->fps, "Frames per second of the motion; default 30"),
           0.1, 1000);
  command.add_flag("--plots", options->plots, "Also draw plots (SVG)");
  return command;
}

void add_details(CLI::App& command, MotionOptions& motion) {
  add_pairs(command, motion);
  add_sliding(command, motion);
  add_tissue(command, motion.tissue);
  add_motion_details(command, motion);
}

}  // namespace

void add_record(Commands& commands) {
  const auto options = std::make_shared<RecordOptions>();
  options->pictures = true;
  CLI::App& command = add_recording(
      commands, "record", "Record a motion as pictures, off-screen",
      "condyle record --motion opening --out out --show bones,teeth,skin:0.4 --film", options);
  command.add_flag("--film", options->film, "Also make film.mp4 (needs the ffmpeg program)");
  command.add_flag("--resume", options->resume, "Complete an interrupted recording");
  command
      .add_option("--also", options->also,
                  "Also draw the motion with other parts into another folder, e.g. "
                  "out/glass=bones,teeth,skin:0.3; repeatable. The motion is simulated once; trace "
                  "and report are written to --out")
      ->type_name("FOLDER=PARTS")
      ->allow_extra_args(false);
  add_pictures(command, options->picture);
  add_details(command, options->motion);
}

void add_run(Commands& commands) {
  const auto options = std::make_shared<RecordOptions>();
  CLI::App& command =
      add_recording(commands, "run", "Simulate a motion without pictures",
                    "condyle run mycase --motion chew.csv --out out --json", options);
  add_details(command, options->motion);
}

}  // namespace condyle
