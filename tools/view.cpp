#include <algorithm>
#include <optional>

#include "engine/core/error.h"
#include "render/window/window.h"
#include "sim/contact/live_distances.h"
#include "sim/motion/measures.h"
#include "sim/simulator/live.h"
#include "tools/common.h"
#include "tools/distance_drawing.h"

namespace condyle {
namespace {

/// Ends the preparation when the window is closed meanwhile.
struct Closed {};

/// The scene, without soft tissue when the face does not allow any: the bones can still be moved.
Scene prepare(const Case& patient, SimulatorSettings settings, const Progress& progress,
              std::string& trouble) {
  try {
    return make_scene(patient, settings, progress);
  } catch (const InputError& error) {
    if (!settings.tissue) throw;
    trouble = std::string("The soft tissue is left out. ") + error.what();
    settings.tissue = false;
    return make_scene(patient, settings, progress);
  }
}

std::vector<MapSurface> map_surfaces(const DistanceMap& map) {
  std::vector<MapSurface> surfaces;
  for (const auto& surface : map.surfaces())
    surfaces.push_back({static_cast<std::size_t>(surface.part), &surface.mesh, surface.normals});
  return surfaces;
}

double widest_opening(const Case& patient, const Motion& motion) {
  double widest = 0;
  constexpr int samples = 200;
  for (int i = 0; i <= samples; ++i)
    widest = std::max(widest,
                      measure(patient, motion.wanted(motion.duration_s * i / samples)).opening_mm);
  return widest;
}

/// Tells the simulation what the hands want otherwise than before. A free part that is put back is
/// wanted where it was loaded.
void hand_over(const Hands& now, const Hands& before, std::span<const MovableBody> bodies,
               LiveSimulation& simulation) {
  for (const auto& body : bodies) {
    Hands one, other;
    one.of(body) = now.of(body);
    other.of(body) = before.of(body);
    if (one == other) continue;
    if (now.of(body) || body.free)
      simulation.drag(body.part, now.of(body).value_or(Pose{}));
    else
      simulation.release(body.part);
  }
}

void show_patient(Window& window, const ViewOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const Progress progress = [&](std::string_view what, double fraction) {
    bar.show(what, fraction);
    window.show_progress(std::string(what), fraction);
    if (!window.open()) throw Closed{};
  };
  const auto settings = simulator_settings(options.motion, common);
  std::string trouble;
  const Scene scene = prepare(open_patient(options.motion.patient, common, bar, progress), settings,
                              progress, trouble);
  progress("preparing the motion", 0.9);
  const std::string spec = options.motion.motion.empty() ? "opening" : options.motion.motion;
  const Motion motion = motion_of(spec, scene.patient, scene.contacts, options.motion.settings,
                                  options.motion.muscles, common.threads);
  // Sliding is felt at once when a hand moves the jaw: its fields are made before.
  if (options.motion.respect_contact || !motion.recorded)
    scene.contacts.prepare_sliding(progress, common.threads);
  window.show_progress("", 1);
  bar.clear();

  const DistanceMapSettings map_settings{.pair_rules = settings.contact.pair_rules};
  WindowScene shown{.parts = scene.patient.parts,
                    .case_name = scene.patient.name,
                    .motion_name = motion.name,
                    .duration_s = motion.duration_s,
                    .max_opening_mm = widest_opening(scene.patient, motion),
                    .notes = scene.patient.notes,
                    .distance_colours = distance_colours({.near_mm = map_settings.reach_mm}),
                    .distance_remarks = distance_remarks(scene.patient),
                    .bodies = movable_bodies(scene.patient.parts)};
  shown.notes.insert(shown.notes.end(), scene.contacts.notes().begin(),
                     scene.contacts.notes().end());
  shown.notes.insert(shown.notes.end(), motion.notes.begin(), motion.notes.end());
  ViewState start;
  start.obey_contact = options.motion.respect_contact || !motion.recorded;
  window.set_scene(shown, start);

  if (!trouble.empty()) window.report_error(trouble);

  LiveSimulation simulation(scene, motion, settings);
  std::optional<LiveDistances> distances;  // made when first wanted
  bool map_sent = false, coloured = false;
  Hands moved;
  FrameState newest;
  while (window.open()) {
    const ViewState& view = window.poll();
    simulation.request({.time_s = view.time_s,
                        .opening_mm = view.opening_mm,
                        .obey_contact = view.obey_contact,
                        .face = view.shows_face(shown)});
    if (!(view.hands == moved)) {
      hand_over(view.hands, moved, shown.bodies, simulation);
      moved = view.hands;
    }
    LoopStatistics loop{.steps_per_second = simulation.steps_per_second(),
                        .message = view.distances && !map_sent ? "Measuring distances" : ""};
    auto frame = simulation.take();
    const bool news = frame.has_value();
    if (news) newest = std::move(*frame);
    if (view.distances && !distances) distances.emplace(scene.patient, map_settings);
    const bool switched = coloured != view.distances;
    if (view.distances && (news || switched)) distances->request(newest);
    coloured = view.distances;
    auto answer = distances ? distances->take() : std::nullopt;
    if (answer && !map_sent) {
      window.set_map_surfaces(map_surfaces(*distances->map()));
      map_sent = true;
      loop.message.clear();
    }
    // A frame waits for its colours, so that both are of one time.
    if (answer && view.distances)
      window.show(std::move(answer->frame), loop, std::move(answer->values));
    else if ((news || switched) && !(view.distances && map_sent))
      window.show(newest, loop);
    else
      window.draw();
  }
}

}  // namespace

int run_view(const ViewOptions& options, const CommonOptions& common) {
  Window window({.title = "Condyle", .ui_scale = options.ui_scale, .light = options.light});
  try {
    show_patient(window, options, common);
  } catch (const Closed&) {
  }
  return 0;
}

}  // namespace condyle
