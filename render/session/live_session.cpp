#include "render/session/live_session.h"

#include <utility>

namespace condyle {
namespace {

std::vector<MapSurface> map_surfaces(const DistanceMap& map) {
  std::vector<MapSurface> surfaces;
  for (const auto& surface : map.surfaces())
    surfaces.push_back({static_cast<std::size_t>(surface.part), &surface.mesh, surface.normals});
  return surfaces;
}

/// Sends the simulation the targets of hands that have changed. A body that is reset and that
/// no motion drives has its target where it was loaded.
void send_hands(const Hands& now, const Hands& before, std::span<const MovableBody> bodies,
                LiveSimulation& simulation) {
  for (const auto& body : bodies) {
    if (body.is_skull()) continue;  // all poses are relative to it
    const auto target = now.of(body);
    if (same(target, before.of(body))) continue;
    if (target || body.roams())
      simulation.drag(body.body, target.value_or(Pose{}));
    else
      simulation.release(body.body);
  }
}

}  // namespace

void LiveSession::start() {
  if (simulation_) state_.retired.add(std::move(simulation_), state_.patient);
  simulation_ = std::make_shared<LiveSimulation>(state_.patient->scene, state_.motion->motion,
                                                 live_settings(state_.settings.simulator),
                                                 state_.motion->opening);
  applied_ = {};
}

void LiveSession::stop() {
  if (simulation_) state_.retired.add(std::move(simulation_), state_.patient);
  if (distances_) state_.retired.add(std::move(distances_), state_.patient);
  map_sent_ = coloured_ = false;
  overlaid_.reset();
  state_.newest.reset();
}

void LiveSession::request(const ViewState& view, const std::optional<Pose>& X_CM_released) {
  simulation_->request({.time_s = view.time_s,
                        .opening_mm = view.opening_mm,
                        .obey_contact = view.obey_contact,
                        .face = view.simulates_tissue(state_.scene),
                        .expression = view.expression});
  Hands hands = view.hands;
  if (X_CM_released) hands.hold_jaw(*X_CM_released);
  if (hands == applied_) return;
  state_.try_or_report("Cannot move the body",
                       [&] { send_hands(hands, applied_, state_.scene.bodies, *simulation_); });
  applied_ = std::move(hands);
}

/// Returns whether there is a new frame.
bool LiveSession::take_frame(const ViewState& view) {
  std::optional<FrameState> frame;
  state_.try_or_report("Cannot simulate the motion", [&] { frame = simulation_->take(); });
  if (!frame) return false;
  state_.newest = std::move(frame);
  const Motion& motion = state_.motion->motion;
  if (motion.muscles && !view.jaw_is_held())
    state_.newest->muscles = motion.muscles(state_.newest->time_s);
  return true;
}

void LiveSession::update(const ViewState& view, const std::optional<Pose>& X_CM_released,
                         const std::shared_ptr<const LineSet>& paths) {
  request(view, X_CM_released);
  const bool is_new = take_frame(view);
  if (!state_.newest) return state_.front_end.draw();
  std::shared_ptr<const MuscleBellies> bellies;
  state_.try_or_report("Cannot draw the muscles",
                       [&] { bellies = bellies_.of(state_.patient, view); });
  const OverlayInputs inputs = OverlayInputs::of(view, paths, bellies);
  const SessionOverlayInputs own = SessionOverlayInputs::of(state_, view);
  if (is_new || inputs != overlaid_ || !(own == overlaid_by_session_)) {
    Overlays shown = view_overlays(*state_.patient, state_.motion->motion, *state_.newest, view,
                                   paths, bellies.get());
    add_session_overlays(state_, view, shown);
    state_.front_end.show_overlays(std::move(shown));
    overlaid_ = inputs;
    overlaid_by_session_ = own;
  }
  show(view, is_new);
}

/// A frame waits for its colours, so that both belong to one time.
void LiveSession::show(const ViewState& view, bool is_new) {
  LoopStatistics loop{.steps_per_second = simulation_->steps_per_second(),
                      .message = view.distances && !map_sent_ ? "Measuring distances" : ""};
  if (view.distances && !distances_)
    distances_ = std::make_shared<LiveDistances>(
        state_.patient->scene.patient,
        DistanceMapSettings{.pair_rules = state_.settings.simulator.contact.pair_rules});
  const bool switched = coloured_ != view.distances;
  if (view.distances && (is_new || switched)) distances_->request(*state_.newest);
  coloured_ = view.distances;
  auto answer = distances_ ? distances_->take() : std::nullopt;
  if (answer && !map_sent_) {
    state_.front_end.set_map_surfaces(map_surfaces(*distances_->map()), distances_);
    map_sent_ = true;
    loop.message.clear();
  }
  if (answer && view.distances)
    state_.front_end.show(std::move(answer->frame), loop, std::move(answer->values));
  else if ((is_new || switched) && !(view.distances && map_sent_))
    state_.front_end.show(*state_.newest, loop);
  else
    state_.front_end.draw();
}

}  // namespace condyle
