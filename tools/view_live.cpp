#include <algorithm>
#include <utility>

#include "tools/view_session.h"

// Of a ViewSession: what the simulation is asked for, and its frames on their way to the window.

namespace condyle {
namespace {

std::vector<MapSurface> map_surfaces(const DistanceMap& map) {
  std::vector<MapSurface> surfaces;
  for (const auto& surface : map.surfaces())
    surfaces.push_back({static_cast<std::size_t>(surface.part), &surface.mesh, surface.normals});
  return surfaces;
}

/// Tells the simulation what the hands want otherwise than before. A free part that is put back is
/// wanted where it was loaded.
void hand_over(const Hands& now, const Hands& before, std::span<const MovableBody> bodies,
               LiveSimulation& simulation) {
  for (const auto& body : bodies) {
    if (body.skull) continue;  // all is told against it
    const auto wanted = now.of(body);
    if (same(wanted, before.of(body))) continue;
    if (wanted || body.free)
      simulation.drag(body.part, wanted.value_or(Pose{}));
    else
      simulation.release(body.part);
  }
}

}  // namespace

void ViewSession::simulate(const ViewState& view) {
  simulation_->request({.time_s = view.time_s,
                        .opening_mm = view.opening_mm,
                        .obey_contact = view.obey_contact,
                        .face = view.simulates_tissue(shown_)});
  Hands hands = view.hands;
  if (falling_) hands.hold_jaw(falling_->X_CM);
  if (!(hands == moved_)) {
    guarded([&] { hand_over(hands, moved_, shown_.bodies, *simulation_); });
    moved_ = std::move(hands);
  }
  LoopStatistics loop{.steps_per_second = simulation_->steps_per_second(),
                      .message = view.distances && !map_sent_ ? "Measuring distances" : ""};
  std::optional<FrameState> frame;
  guarded([&] { frame = simulation_->take(); });
  const bool news = frame.has_value();
  if (news) {
    newest_ = std::move(frame);
    if (motion_->motion.muscles && !view.jaw_is_held())
      newest_->muscles = motion_->motion.muscles(newest_->time_s);
  }
  if (!newest_) return window_.draw();
  if (OverlayWish wish = OverlayWish::of(view, paths_); news || wish != overlaid_) {
    window_.show_overlays(view_overlays(*patient_, motion_->motion, *newest_, view, paths_));
    overlaid_ = std::move(wish);
  }
  if (view.distances && !distances_)
    distances_ = std::make_shared<LiveDistances>(
        patient_->scene.patient, DistanceMapSettings{.pair_rules = settings_.contact.pair_rules});
  const bool switched = coloured_ != view.distances;
  if (view.distances && (news || switched)) distances_->request(*newest_);
  coloured_ = view.distances;
  auto answer = distances_ ? distances_->take() : std::nullopt;
  if (answer && !map_sent_) {
    window_.set_map_surfaces(map_surfaces(*distances_->map()), distances_);
    map_sent_ = true;
    loop.message.clear();
  }
  // A frame waits for its colours, so that both are of one time.
  if (answer && view.distances)
    window_.show(std::move(answer->frame), loop, std::move(answer->values));
  else if ((news || switched) && !(view.distances && map_sent_))
    window_.show(*newest_, loop);
  else
    window_.draw();
}

}  // namespace condyle
