#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/mesh/measure.h"
#include "render/arch_view.h"
#include "render/gl_context.h"
#include "render/recorder.h"
#include "render/scene_renderer.h"
#include "sim/case/tissue_plan_file.h"
#include "sim/report/motion_plots.h"
#include "sim/report/report.h"
#include "sim/report/trace.h"
#include "tools/common.h"
#include "tools/displacement_drawing.h"
#include "tools/distance_drawing.h"
#include "tools/tissue_options.h"

namespace condyle {
namespace {

// Fixed, so that pictures can be compared; nothing goes farther at full opening.
constexpr double displacement_end_mm = 60;

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

std::string camera_text(const Camera& camera, bool spin) {
  const auto& t = camera.target;
  const auto& d = camera.direction;
  const auto& u = camera.up;
  return fmt::format("{}{} {} {} / {} {} {} / {} {} {} / {} {}", spin ? "spin " : "", t.x(), t.y(),
                     t.z(), d.x(), d.y(), d.z(), u.x(), u.y(), u.z(), camera.distance_mm,
                     camera.field_of_view_deg);
}

/// The box of what is shown, grown by where the motion takes the mandible: what the camera keeps in
/// view.
std::pair<Eigen::Vector3d, Eigen::Vector3d> view_box(const Case& patient, const Motion& motion,
                                                     const PictureSettings& picture) {
  constexpr int samples = 24;
  constexpr std::size_t stride = 16;  // a few vertices tell the extent
  Box box;
  for (const auto& part : patient.parts) {
    const auto opacity = picture.part_opacity.find(part.name);
    if (opacity != picture.part_opacity.end() && opacity->second <= 0) continue;
    const Body body = body_of(part.role);
    const bool moves = (body == Body::free ? part.carrier : body) == Body::mandible;
    for (int i = 0; i <= (moves ? samples : 0); ++i) {
      const Pose X_CM = moves ? motion.wanted(motion.duration_s * i / samples) : Pose{};
      for (std::size_t v = 0; v < part.mesh.vertices.size(); v += stride)
        box.add(X_CM * part.mesh.vertices[v]);
    }
  }
  if (box.empty()) throw InputError("--show: nothing is left to draw");
  return {box.low, box.high};
}

/// Draws the frames of one recording and keeps them.
class PictureTaker {
 public:
  PictureTaker(const RecordOptions& options, const Scene& scene, const Motion& motion,
               const SimulatorSettings& settings, const FrameTimes& times)
      : renderer_(scene.patient.parts), spin_(options.camera == "spin"), frames_(times.count) {
    std::tie(picture_.width, picture_.height) = parse_size(options.size);
    const double aspect = static_cast<double>(picture_.width) / picture_.height;
    const SurfaceMap map = apply_show_list(options.show, scene.patient.parts, picture_);
    const bool distance = map == SurfaceMap::distance;
    if (ArchView::names(options.camera)) {
      arch_.emplace(options.camera, scene.patient.parts, aspect);
      for (const auto& [part, opacity] : arch_->hidden()) picture_.part_opacity[part] = opacity;
    }
    const auto [low, high] = view_box(scene.patient, motion, picture_);
    camera_ = arch_ ? arch_->at_rest()
                    : parse_camera(spin_ ? "front" : options.camera, low, high, aspect);
    if (distance)
      // Finer than a window has time for.
      distances_.emplace(scene.patient,
                         DistanceMapSettings{.reach_mm = options.distance_near_mm,
                                             .teeth_edge_mm = 0.4,
                                             .bone_edge_mm = 1,
                                             .most_triangles = 400000,
                                             .pair_rules = settings.contact.pair_rules},
                         settings.threads, renderer_);
    if (map == SurfaceMap::displacement)
      displacement_.emplace(scene.patient, displacement_end_mm, renderer_);
    recorder_.emplace(RecorderSettings{
        .folder = options.out,
        .width = picture_.width,
        .height = picture_.height,
        .frames = times.count,
        .frames_per_second = times.fps(),
        .film = options.film,
        .resume = options.resume,
        .identity = {
            {"condyle", CONDYLE_VERSION},
            {"case", hash_text(case_hash(scene.patient))},
            {"motion",
             motion.name + " " + hash_text(motion_hash(motion, times, SimulatorSettings{}.step_s))},
            {"camera", (arch_ ? options.camera + " " : "") + camera_text(camera_, spin_)},
            {"show", options.show},
            {"distances",
             distance ? fmt::format("up to {} mm", options.distance_near_mm) : std::string("none")},
            {"contact", contact_text(options.motion)},
            {"tissue", tissue_text(options.motion, scene.patient)}}});
    kept_ = recorder_->kept_frames();
  }

  bool wanted(int frame) const { return !recorder_->has(frame); }
  int kept() const { return kept_; }

  void take(int frame, FrameState& state) {
    const StageTimer timer(state.times, Stage::render);
    renderer_.update(state);
    if (distances_) distances_->color(renderer_, state);
    if (displacement_) displacement_->color(renderer_, state);
    const double turn = spin_ ? 2 * M_PI * frame / std::max(frames_ - 1, 1) : 0;
    const Camera camera = arch_ ? arch_->at(state) : turned(camera_, turn);
    Image image = renderer_.picture(camera, picture_);
    if (distances_) distances_->add_legend_to(image);
    if (displacement_) displacement_->add_legend_to(image);
    recorder_->add(frame, std::move(image));
  }
  void finish() { recorder_->finish(); }

 private:
  OffscreenContext context_;
  SceneRenderer renderer_;
  bool spin_;
  int frames_;
  int kept_ = 0;
  PictureSettings picture_;
  Camera camera_;
  std::optional<ArchView> arch_;
  std::optional<DistanceDrawing> distances_;
  std::optional<DisplacementDrawing> displacement_;
  std::optional<Recorder> recorder_;
};

/// Fails before the long work when the command line is wrong in a way that needs no patient.
void check_early(const RecordOptions& options) {
  if (!options.pictures) return;
  parse_size(options.size);
  if (options.camera != "spin" && !ArchView::names(options.camera))
    parse_camera(options.camera, {-1, -1, -1}, {1, 1, 1}, 1);
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
  bar.show("preparing the motion", 0);
  Playback playback(scene, motion_of(options.motion, scene, common.threads), settings,
                    options.motion.respect_contact);
  const Motion& motion = playback.motion();
  const FrameTimes times = frame_times(options, motion.duration_s);

  std::optional<PictureTaker> pictures;
  if (options.pictures) pictures.emplace(options, scene, motion, settings, times);
  TraceWriter trace(options.out / "trace.csv", motion.muscle_names);
  MotionReport report(scene, motion, settings);
  for (int i = 0; i < times.count; ++i) {
    FrameState frame = playback.at(times[i]);
    if (pictures && pictures->wanted(i)) pictures->take(i, frame);
    trace.add(i, frame);
    report.add(frame);
    bar.show(fmt::format("frame {} of {}", i + 1, times.count), (i + 1.0) / times.count);
  }
  bar.clear();
  trace.finish();
  const std::string json = report.json();
  write_file(options.out / "report.json", json);
  if (motion.muscles) write_file(options.out / "excitations.csv", excitations_csv(motion));
  if (options.plots) {
    for (const auto& plot : motion_plots(report.series()))
      write_file(options.out / (plot.name + ".svg"), panels_svg(plot.panels));
  }
  if (pictures) pictures->finish();
  if (common.json) fmt::print("{}", json);
  if (!common.quiet) {
    for (const auto& note : scene.contacts.notes()) fmt::print(stderr, "note: {}\n", note);
    for (const auto& note : motion.notes) fmt::print(stderr, "note: {}\n", note);
    fmt::print(stderr, "{}", report.text());
    if (pictures && pictures->kept() > 0)
      fmt::print(stderr, "{} frames were there already and were kept\n", pictures->kept());
    fmt::print(stderr, "results are in {}\n", options.out.string());
  }
  return 0;
}

}  // namespace condyle
