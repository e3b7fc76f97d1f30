#include "render/recording/frame_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "render/image/gap_colours.h"
#include "render/image/raster_2d.h"
#include "render/overlay/place_labels.h"
#include "render/recording/anatomy_drawing.h"
#include "render/recording/caption.h"
#include "render/recording/facial_bellies.h"
#include "render/recording/muscle_looks.h"
#include "render/scene/face_shape.h"
#include "sim/muscles/default_muscles.h"
#include "sim/tissue/model.h"

namespace condyle {
namespace {

/// The box of the displayed parts, extended by the motion of the mandible, which the camera keeps
/// in view. Empty if nothing is drawn.
Box drawn_box(const Case& patient, const Motion& motion, const PictureSettings& picture) {
  constexpr int samples = 24;
  constexpr std::size_t few = 1000;  // larger parts are subsampled to find the extent
  Box box;
  for (const auto& part : patient.parts) {
    const auto opacity = picture.part_opacity.find(part.name);
    if (opacity != picture.part_opacity.end() && opacity->second <= 0) continue;
    if (part.role == Role::face && picture.skin_opacity <= 0) continue;
    const bool moves =
        is_rigid(part.role) && patient.bodies.is_within(part.body, patient.jaw.lower_arch);
    const std::size_t stride = part.mesh.vertices.size() > few ? 16 : 1;
    for (int i = 0; i <= (moves ? samples : 0); ++i) {
      const Pose X_CM = moves ? motion.target(motion.duration_s * i / samples) : Pose{};
      for (std::size_t v = 0; v < part.mesh.vertices.size(); v += stride)
        box.add(X_CM * part.mesh.vertices[v]);
    }
  }
  return box;
}

std::pair<Eigen::Vector3d, Eigen::Vector3d> view_box(const Case& patient, const Motion& motion,
                                                     const PicturePlan& plan) {
  Box box = drawn_box(patient, motion, plan.settings);
  // A window may show overlays only.
  if (box.empty() && plan.window) box = drawn_box(patient, motion, {});
  if (box.empty()) throw InputError("nothing is left to draw: --show or --also hides every part");
  return {box.low, box.high};
}

RecordingCamera camera_of(const std::string& text, const PicturePlan& plan, const Case& patient,
                          const Eigen::AlignedBox3d& box) {
  using Turning = RecordingCamera::Turning;
  if (plan.window && (text == own_camera || text == turning_camera))
    return {text, plan.window->camera, text == own_camera ? Turning::no : Turning::once,
            plan.window->upright};
  const double aspect = static_cast<double>(plan.settings.width) / plan.settings.height;
  return {text, patient, box.min(), box.max(), aspect};
}

/// A camera and its recording.
struct PlannedView {
  RecordingCamera camera;
  PictureSettings settings;
  RecorderSettings recorder;
};

void plan_views(const PicturePlan& plan, const RecordingFiles& files,
                const RecordingSubject& subject, std::vector<PlannedView>& views) {
  const Case& patient = subject.scene.patient;
  const auto [low, high] = view_box(patient, subject.motion, plan);
  for (const auto& text : plan.cameras) {
    RecordingCamera camera = camera_of(text, plan, patient, {low, high});
    RecorderSettings recorder{
        .folder = plan.cameras.size() == 1 ? files.out : files.out / camera.name(),
        .width = (plan.before_after ? 3 : 1) * plan.settings.width,
        .height = plan.settings.height,
        .frames = subject.frames,
        .frames_per_second = subject.frames_per_second,
        .film = files.film,
        .resume = files.resume,
        .identity = subject.identity};
    recorder.identity["camera"] = camera.description();
    recorder.identity.insert(plan.words.begin(), plan.words.end());
    views.push_back({std::move(camera), plan.settings, std::move(recorder)});
  }
}

std::vector<PlannedView> planned_views(const PicturePlan& plan, const RecordingFiles& files,
                                       const RecordingSubject& subject) {
  std::vector<PlannedView> views;
  plan_views(plan, files, subject, views);
  for (const OtherLook& other : files.others) {
    PicturePlan look = plan;
    look.settings = other.settings;
    look.words = other.words;
    RecordingFiles there = files;
    there.out = other.out;
    plan_views(look, there, subject, views);
  }
  return views;
}

}  // namespace

RecordingThere recording_there(const PicturePlan& plan, const RecordingFiles& files,
                               const RecordingSubject& subject) {
  RecordingThere all;
  for (const PlannedView& view : planned_views(plan, files, subject)) {
    const RecordingThere there = recording_there(view.recorder);
    all.pictures += there.pictures;
    for (const auto& name : there.differs)
      if (std::find(all.differs.begin(), all.differs.end(), name) == all.differs.end())
        all.differs.push_back(name);
  }
  return all;
}

FrameRenderer::FrameRenderer(const PicturePlan& plan, const RecordingFiles& files,
                             const RecordingSubject& subject)
    : subject_(subject), plan_(plan), rest_(rest_frame(subject.scene)) {
  const auto& patient = subject.scene.patient;
  const bool distance = plan_.map == SurfaceMap::distance;
  if (plan_.overlays.muscles || plan_.overlays.muscle_labels)
    muscles_.emplace(muscles_of(patient), patient);
  if (subject.settings.face) carry_face(subject.scene, rest_, subject.settings.threads);
  if (plan_.before) rest_ = *plan_.before;

  for (PlannedView& planned : planned_views(plan_, files, subject)) {
    View view{std::move(planned.camera), std::move(planned.settings), nullptr};
    if (const auto* arch = view.camera.arch())
      for (const auto& [part, opacity] : arch->hidden()) view.settings.part_opacity[part] = opacity;
    view.recorder = std::make_unique<Recorder>(planned.recorder);
    kept_ += view.recorder->kept_frames();
    views_.push_back(std::move(view));
  }

  // A map has its own threads for its values.
  const bool mapped = distance || plan_.patches || plan_.map == SurfaceMap::displacement;
  // Large pictures would need twice the memory.
  constexpr double max_pixels_for_two = 1.7e7;
  const double pixels = static_cast<double>(plan_.settings.width) * plan_.settings.height *
                        plan_.settings.supersampling * plan_.settings.supersampling;
  drawers_.emplace(patient.parts, mapped || pixels > max_pixels_for_two ? 1 : 2, plan_.operation);
  const PictureSettings& size = plan_.settings;
  if (const int most = drawers_->max_side() / size.supersampling;
      size.width > most || size.height > most)
    throw MachineError(fmt::format(
        "pictures of {}x{} are too large for the graphics driver: at most {} pixels a side{}",
        size.width, size.height, most,
        size.supersampling > 1 ? fmt::format(" when drawn {}x finer", size.supersampling) : ""));
  for (int drawer = 0; drawer < drawers_->count(); ++drawer) desks_.emplace_back();
  for (auto& view : views_) view.recorder->set_driver(drawers_->driver());
  if (mapped)
    drawers_->add([this](SceneRenderer& renderer, int drawer) {
      prepare(renderer, desks_[static_cast<std::size_t>(drawer)]);
      return [] {};
    });
}

RenderMetadata FrameRenderer::facts() const {
  const int asked = plan_.settings.samples;
  const std::string drivers = views_.empty() ? "" : views_.front().recorder->drivers();
  return {drivers.empty() ? drawers_->driver() : drivers, asked,
          std::min(asked, drawers_->max_samples())};
}

void FrameRenderer::prepare(SceneRenderer& renderer, Desk& desk) const {
  const auto& patient = subject_.scene.patient;
  const bool distance = plan_.map == SurfaceMap::distance;
  if (distance || plan_.patches)
    // Finer than a window has time for.
    desk.distances.emplace(patient,
                           // Beyond the coloured area by an edge's length: its limit is a smooth
                           // line.
                           DistanceMapSettings{.reach_mm = distance ? plan_.near_mm + 1 : 1,
                                               .teeth_edge_mm = 0.4,
                                               .bone_edge_mm = 1,
                                               .max_triangles = 400000,
                                               .pair_rules = subject_.settings.contact.pair_rules},
                           subject_.settings.threads, renderer,
                           distance ? distance_colours({.near_mm = plan_.near_mm})
                                    : patch_colours(*plan_.settings.mapped_up_to));
  if (plan_.map == SurfaceMap::displacement) desk.displacement.emplace(patient.parts);
}

bool FrameRenderer::is_drawn(int frame) const {
  for (const auto& view : views_)
    if (!view.recorder->has(frame)) return true;
  return false;
}

Image FrameRenderer::drawn(const PictureSettings& settings, const Camera& camera, const Shot& shot,
                           bool with_map) const {
  auto& [renderer, desk, state, overlays] = shot;
  renderer.update(state);
  if (desk.distances) desk.distances->color(renderer, state);
  if (desk.displacement) {
    if (with_map)
      desk.displacement->color(renderer, state);
    else
      desk.displacement->clear(renderer);
  }
  desk.overlays.send(renderer, overlays);
  return renderer.picture(camera, settings);
}

Overlays FrameRenderer::overlays_of(const FrameState& state, bool with_paths) const {
  Overlays all = plan_.window ? plan_.window->overlays(state) : chosen_overlays(state, with_paths);
  if (plan_.settings.ghost) all.key.push_back(ghost_key(*plan_.settings.ghost));
  return all;
}

Overlays FrameRenderer::chosen_overlays(const FrameState& state, bool with_paths) const {
  Overlays all;
  all.lines = overlay_lines(subject_.scene, state, plan_.overlays);
  if (plan_.overlays.paths && with_paths) all.lines["paths"] = paths_.lines();
  const TissueModel* tissue = state.tissue.nodes.empty() ? nullptr : subject_.scene.tissue.get();
  all.key = overlay_key(plan_.overlays, tissue != nullptr);
  if (muscles_)
    add_muscles(*muscles_, subject_.motion, state, {}, plan_.overlays.muscle_labels, all);
  if (plan_.overlays.facial_muscles && tissue) {
    all.bodies["facial muscles"] = facial_bellies(*tissue, state.tissue);
    all.key.push_back(facial_muscle_key());
  }
  if (plan_.overlays.layers && tissue)
    for (int sheet = 0; sheet < tissue->mesh->sheets; ++sheet) {
      all.sheets[layer_overlay_name(sheet)] = layer_sheet(*tissue, state.tissue, sheet);
      all.key.push_back(layer_key(*tissue, sheet));
    }
  return all;
}

Image FrameRenderer::picture(const View& view, const Camera& camera, const Shot& shot,
                             Annotations& notes) const {
  Image image = drawn(view.settings, camera, shot, true);
  if (plan_.wipe) {
    const Overlays still = overlays_of(rest_, false);
    PictureSettings of_rest = view.settings;
    of_rest.before_operation = plan_.operation != nullptr;
    image = wiped(drawn(of_rest, camera, {shot.renderer, shot.desk, rest_, still}, true), image,
                  *plan_.wipe, plan_.settings.backdrop);
    notes.line_at = *plan_.wipe;
  }
  draw_labels(image, shot.desk.words, camera, shot.overlays.labels, plan_.settings.backdrop);
  add_key(image, shot.desk.words, shot.overlays.key, plan_.settings.backdrop);
  if (shot.desk.distances)
    keep_clear_of(notes, shot.desk.distances->add_legend_to(image, plan_.settings.backdrop), image);
  if (shot.desk.displacement)
    keep_clear_of(notes, shot.desk.displacement->add_legend_to(image, plan_.settings.backdrop),
                  image);
  return image;
}

Image FrameRenderer::before_after(const View& view, const Camera& camera, const Shot& shot) const {
  std::array<Image, 3> images;  // at rest, now, the separating line
  const Overlays still = overlays_of(rest_, false);
  for (std::size_t i = 0; i < images.size(); ++i) {
    const bool mapped = i == 2, moved = i > 0;
    images[i] = drawn(view.settings, camera,
                      moved ? shot : Shot{shot.renderer, shot.desk, rest_, still}, mapped);
    auto notes = plan_.annotations;
    draw_labels(images[i], shot.desk.words, camera, (moved ? shot.overlays : still).labels,
                plan_.settings.backdrop);
    if (i == 0) add_key(images[i], shot.desk.words, shot.overlays.key, plan_.settings.backdrop);
    if (mapped)
      keep_clear_of(notes,
                    shot.desk.displacement->add_legend_to(images[i], plan_.settings.backdrop),
                    images[i]);
    annotate(images[i], shot.desk.words, camera, notes);
  }
  return beside(images, plan_.settings.backdrop);
}

Image FrameRenderer::finished(const View& view, int frame, const Shot& shot) const {
  const double fraction =
      subject_.frames > 1 ? static_cast<double>(frame) / (subject_.frames - 1) : 0;
  Camera camera = view.camera.at(fraction, shot.state);
  if (const auto& parts = subject_.scene.patient.parts; shows_life(parts, view.settings)) {
    const Pose X_CM = shot.state.poses[lower_jaw_of(parts)];
    camera = seeing_extension(camera, *view.settings.life,
                              life_signs(shot.state.time_s, X_CM).extension);
  }
  auto notes = plan_.annotations;
  notes.caption = caption_lines(plan_.caption, frame, shot.state, subject_.motion.name);
  Image image;
  if (plan_.before_after) {
    image = before_after(view, camera, shot);
    notes = {.backdrop = notes.backdrop, .caption = notes.caption};
  } else {
    image = picture(view, camera, shot, notes);
  }
  annotate(image, shot.desk.words, camera, notes);
  return image;
}

void FrameRenderer::take(int frame, FrameState state, const Done& done) {
  paths_.add(state.measures);
  struct Work {
    FrameState state;
    Overlays overlays;
    std::vector<std::pair<Recorder*, Image>> images;
  };
  const bool draw = is_drawn(frame);
  const auto work = std::make_shared<Work>();
  if (draw) work->overlays = overlays_of(state, true);
  work->state = std::move(state);
  drawers_->add([this, frame, draw, work, done](SceneRenderer& renderer, int drawer) {
    if (draw) {
      const StageTimer timer(work->state.times, Stage::render);
      const Shot shot = {renderer, desks_[static_cast<std::size_t>(drawer)], work->state,
                         work->overlays};
      for (const auto& view : views_)
        if (!view.recorder->has(frame))
          work->images.emplace_back(view.recorder.get(), finished(view, frame, shot));
    }
    return [frame, work, done] {
      for (auto& [recorder, image] : work->images) recorder->add(frame, std::move(image));
      done(frame, work->state);
    };
  });
}

void FrameRenderer::wait() { drawers_->finish(); }

void FrameRenderer::finish() {
  wait();
  for (auto& view : views_) view.recorder->finish();
}

}  // namespace condyle
