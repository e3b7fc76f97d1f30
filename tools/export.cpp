#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <ctime>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "engine/core/atomic_output.h"
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/text_list.h"
#include "engine/mesh/measure.h"
#include "engine/mesh_io/mesh_files.h"
#include "render/page/moving_patient.h"
#include "render/page/patient_page.h"
#include "sim/export/posed_patient.h"
#include "sim/operated/operated_scene.h"
#include "sim/plan/plan_file.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/motion_options.h"

namespace condyle {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string> export_kinds = {"stl",     "ply",        "glb",
                                               "markups", "transforms", "page"};
constexpr const char* index_file = "export.json";

struct ExportOptions {
  MotionOptions motion;
  fs::path out;
  std::string write = "stl,ply,glb,markups,transforms,page";
  std::string title = {};
  double at_s = 0;
  double fps = 60;
  int triangles = 20000;
  double face_opacity = 0.5;
};

std::set<std::string> kinds_of(const std::string& list) {
  std::set<std::string> kinds;
  for (const std::string& kind : split_list(list)) {
    if (std::find(export_kinds.begin(), export_kinds.end(), kind) == export_kinds.end())
      throw InputError(
          fmt::format("--write {}: unknown; known are {}", kind, fmt::join(export_kinds, ", ")));
    kinds.insert(kind);
  }
  if (kinds.empty()) throw InputError("--write: names nothing to write");
  return kinds;
}

/// Names that are valid on every file system, each used once.
class FileNames {
 public:
  std::string of(std::string name) {
    for (char& c : name)
      if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
    const std::string plain = name.empty() ? "_" : name;
    std::string free = plain;
    for (int i = 2; !used_.insert(free).second; ++i) free = fmt::format("{}_{}", plain, i);
    return free;
  }

 private:
  std::set<std::string> used_;
};

/// The motion in the file's animation. The name of a file stays out of what is passed on.
std::string motion_word(const std::string& spec) {
  const auto& known = builtin_motions();
  return std::find(known.begin(), known.end(), spec) != known.end() ? spec : "motion";
}

Json box_json(const Box& box) {
  return {{"low_mm", {box.low.x(), box.low.y(), box.low.z()}},
          {"high_mm", {box.high.x(), box.high.y(), box.high.z()}}};
}

/// What is exported.
struct Exported {
  const Scene& scene;
  const Operated* operated;               // of the plan, or null
  const std::vector<FrameState>& frames;  // of the motion; one without
  const FrameState& frame;                // whose pose the surfaces have
  const Motion* motion;                   // null without
};

/// Writes the files of one export and their list.
class ExportFiles {
 public:
  ExportFiles(AtomicOutput& files, const ExportOptions& options, Json index)
      : files_(files), options_(options), index_(std::move(index)) {
    index_["files"] = Json::array();
  }

  void write(const Exported& data, const std::set<std::string>& kinds) {
    if (kinds.contains("stl") || kinds.contains("ply")) write_surfaces(data, kinds);
    if (kinds.contains("markups")) write_markups(data);
    if (kinds.contains("transforms")) write_transforms(data);
    if (kinds.contains("glb") || kinds.contains("page")) write_motion(data, kinds);
    files_.write(index_file, index_.dump(2) + "\n");
  }
  const Json& index() const { return index_; }

 private:
  void list(const std::string& file, Json facts) {
    facts["file"] = file;
    index_["files"].push_back(std::move(facts));
  }

  void write_surfaces(const Exported& data, const std::set<std::string>& kinds) {
    FileNames names;
    for (const PosedSurface& surface : posed_surfaces(data.scene, data.frame)) {
      const std::string name = names.of(surface.name);
      Json facts = {{"part", surface.name},
                    {"vertices", surface.mesh.vertices.size()},
                    {"triangles", surface.mesh.triangles.size()},
                    {"bounds", box_json(bounding_box(surface.mesh))}};
      if (kinds.contains("stl")) {
        write_stl(surface.mesh, files_.path(name + ".stl"));
        list(name + ".stl", facts);
      }
      if (kinds.contains("ply")) {
        write_ply(surface.mesh, files_.path(name + ".ply"));
        list(name + ".ply", facts);
      }
    }
  }

  void write_markups(const Exported& data) {
    const Landmarks now = posed_landmarks(data.scene, data.frame);
    files_.write("landmarks.mrk.json", slicer_markups({landmark_markup(now, "landmarks")}));
    list("landmarks.mrk.json", {{"points", now.points.size()}});
    const auto measures = measure_markups(data.scene, data.frame, data.operated);
    files_.write("measures.mrk.json", slicer_markups(measures));
    list("measures.mrk.json", {{"measures", measures.size()}});
  }

  void write_transforms(const Exported& data) {
    FileNames names;
    for (const MovedBody& body : moved_bodies(data.scene, data.frame, data.operated)) {
      const std::string file = names.of(body.name) + ".tfm";
      files_.write(file, itk_transform(body.X));
      list(file, {{"body", body.name}});
    }
  }

  void write_motion(const Exported& data, const std::set<std::string>& kinds) {
    MovingPatient moving =
        moving_patient(data.scene.patient.bodies, data.scene.patient.parts, data.frames,
                       {.most_triangles = options_.triangles,
                        .generator = "Condyle " CONDYLE_VERSION,
                        .motion = motion_word(options_.motion.motion)});
    Json facts = {{"frames", data.frames.size()},
                  {"face_keys", moving.keys},
                  {"face_key_error_mm", moving.key_error_mm}};
    if (kinds.contains("glb")) {
      files_.write("patient.glb", glb_bytes(moving.scene));
      list("patient.glb", facts);
    }
    if (!kinds.contains("page")) return;
    PatientPage page{.title = options_.title,
                     .subtitle = subtitle(data),
                     .glb = {},
                     .times_s = {},
                     .opening_mm = {},
                     .phases = {},
                     .face_opacity = options_.face_opacity,
                     .program = "Condyle " CONDYLE_VERSION,
                     .date = index_["date"].get<std::string>()};
    if (page.title.empty())
      page.title = data.operated ? "The patient after the planned operation" : "The patient";
    for (const FrameState& frame : data.frames) {
      page.times_s.push_back(frame.time_s);
      page.opening_mm.push_back(frame.measures.opening_mm);
    }
    if (data.motion)
      for (const MotionPhase& phase : data.motion->phases)
        page.phases.push_back({phase.name, phase.start_s, phase.end_s});
    page.hashes = {{"Case", index_["case_hash"].get<std::string>()}};
    if (data.operated) page.hashes.push_back({"Plan", index_["plan_hash"].get<std::string>()});
    for (GltfNode& node : moving.scene.nodes)
      if (node.surface) node.surface->normals.clear();  // the page computes its own
    page.glb = glb_bytes(moving.scene);
    const std::string html = patient_page(page);
    facts["bytes"] = html.size();
    files_.write("page.html", html);
    list("page.html", facts);
  }

  static std::string subtitle(const Exported& data) {
    double widest = 0;
    for (const FrameState& frame : data.frames)
      widest = std::max(widest, frame.measures.opening_mm);
    if (data.frames.size() < 2) return "";
    return fmt::format("{}, {:.1f} s, opening up to {:.1f} mm",
                       data.scene.tissue ? "Bones and soft tissue in motion" : "Bones in motion",
                       data.frames.back().time_s, widest);
  }

  AtomicOutput& files_;
  const ExportOptions& options_;
  Json index_;
};

/// Files that an earlier export into the folder listed.
std::set<std::string> listed_files(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code none;
  if (!fs::is_regular_file(folder / index_file, none)) return names;
  try {
    const Json index = Json::parse(read_file(folder / index_file));
    if (!index.at("program").get<std::string>().starts_with("Condyle")) return {};
    for (const Json& file : index.at("files")) names.insert(file.at("file").get<std::string>());
  } catch (const std::exception&) {
    return {};  // not ours, or damaged: then nothing is removed
  }
  return names;
}

void remove_stale(const fs::path& folder, const std::set<std::string>& earlier, const Json& index) {
  std::set<std::string> kept;
  for (const Json& file : index["files"]) kept.insert(file["file"].get<std::string>());
  std::error_code none;
  for (const std::string& name : earlier)
    if (!kept.contains(name) && fs::path(name).filename() == name) fs::remove(folder / name, none);
}

/// Frames of the motion from start to end; one without a motion.
std::vector<FrameState> frames_of(const ExportOptions& options, const Scene& scene,
                                  const std::optional<Motion>& motion,
                                  const SimulatorSettings& settings, ProgressBar& bar) {
  if (!motion) {
    std::vector<FrameState> frames = {rest_frame(scene)};
    if (scene.tissue) carry_face(scene, frames.front(), settings.threads);
    return frames;
  }
  constexpr double most_frames = 1200;
  const double count = std::max(1.0, std::round(motion->duration_s * options.fps)) + 1;
  if (!(count <= most_frames))
    throw InputError(fmt::format("--fps {}: makes {} frames of {} s; at most {} are exported",
                                 options.fps, count, motion->duration_s, most_frames));
  Playback playback(scene, *motion, settings, options.motion.respect_contact);
  std::vector<FrameState> frames;
  for (int i = 0; i < static_cast<int>(count); ++i) {
    frames.push_back(playback.at(motion->duration_s * i / (count - 1)));
    bar.show(fmt::format("frame {} of {}", i + 1, count), (i + 1) / count);
  }
  return frames;
}

int run_export(const ExportOptions& options, const CommonOptions& common) {
  const std::set<std::string> kinds = kinds_of(options.write);
  const bool moves = !options.motion.motion.empty();
  if (moves) check_motion(options.motion);
  ProgressBar bar(common);
  auto settings = simulator_settings(options.motion, common);
  settings.face = settings.tissue;
  settings.step_s = 1.0 / 60;
  const std::set<std::string> earlier = listed_files(options.out);
  AtomicOutput files(options.out);  // fails before the computation
  const std::optional<Plan> plan = plan_of(options.motion.plan);
  Case patient = open_patient(case_of(options.motion), common, bar);
  if (moves) check_motion(options.motion, patient);
  const std::string case_hash = geometry_hash(geometry_of(patient));
  std::optional<Operated> operated;
  if (plan) operated = apply_plan(patient, *plan);
  if (operated && !operated->problems.empty())
    throw InputError(options.motion.plan.string() + ": " +
                     fmt::format("{}", fmt::join(operated->problems, "; ")));
  const Scene scene = scene_of(options.motion, std::move(patient), settings, bar.callback());
  print_notes(scene, options.motion.patient, common, bar);
  std::optional<Motion> motion;
  if (moves) motion = motion_of(options.motion, scene, common.threads);
  if (options.at_s > (motion ? motion->duration_s : 0))
    throw InputError(fmt::format("--at {}: lies after the end of the motion, {} s", options.at_s,
                                 motion ? motion->duration_s : 0));
  const auto frames = frames_of(options, scene, motion, settings, bar);
  const auto nearest =
      std::min_element(frames.begin(), frames.end(), [&](const FrameState& a, const FrameState& b) {
        return std::abs(a.time_s - options.at_s) < std::abs(b.time_s - options.at_s);
      });
  bar.show("writing", 0.95);
  Json index = {{"program", "Condyle " CONDYLE_VERSION},
                {"date", fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)))},
                {"notice", "For research and education, not for clinical use."},
                {"units", "mm"},
                {"axes", "LPS"},
                {"glb_units", "m"},
                {"glb_axes", "LSA"},
                {"transforms",
                 "ITK, LPS, mm, resampling convention: each file holds the inverse of the body's "
                 "displacement from the case, as 3D Slicer expects"},
                {"case_hash", case_hash}};
  if (plan) index["plan_hash"] = plan_hash(*plan);
  index["pose"] = {{"time_s", nearest->time_s}, {"opening_mm", nearest->measures.opening_mm}};
  ExportFiles writer(files, options, std::move(index));
  writer.write(
      {scene, operated ? &*operated : nullptr, frames, *nearest, motion ? &*motion : nullptr},
      kinds);
  files.finish();
  remove_stale(options.out, earlier, writer.index());
  bar.clear();
  if (common.json) fmt::print("{}\n", writer.index().dump(2));
  if (common.prints_summary()) {
    if (motion)
      for (const auto& note : motion->notes) fmt::print(stderr, "note: {}\n", note);
    fmt::print(stderr, "{} files are in {}; {} lists them\n", writer.index()["files"].size(),
               options.out.string(), (options.out / index_file).string());
  }
  return 0;
}

}  // namespace

void add_export(Commands& commands) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App& command = commands.add(
      "export",
      "Write the patient for other programs: surfaces, animation, markups, transforms, page",
      "condyle export mycase --plan plan.json --motion opening --out out",
      [options](const CommonOptions& common) { return run_export(*options, common); });
  add_motion(command, options->motion);
  command.add_option("--out", options->out, "Folder for the files, which export.json lists")
      ->type_name("FOLDER")
      ->required();
  command
      .add_option("--write", options->write,
                  fmt::format("What to write, separated by commas; default {}", options->write))
      ->type_name("LIST");
  in_range(command.add_option("--at", options->at_s,
                              "Time of the motion at which surfaces, markups and transforms are "
                              "taken, s; default 0, its start"),
           0, 3600);
  in_range(
      command.add_option("--fps", options->fps, "Frames of the animation per second; default 60"),
      1, 120);
  in_range(command.add_option("--triangles", options->triangles,
                              "Triangles of each surface in GLB and page, about; default 20000"),
           500, 5000000);
  command.add_option("--title", options->title, "Heading of the page")->type_name("TEXT");
  in_range(command.add_option("--face", options->face_opacity,
                              "Opacity of the face when the page is opened; default 0.5"),
           0, 1);
  add_pairs(command, options->motion);
  add_sliding(command, options->motion);
  add_tissue(command, options->motion.tissue);
  add_motion_details(command, options->motion);
}

}  // namespace condyle
