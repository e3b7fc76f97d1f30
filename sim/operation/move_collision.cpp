#include "sim/operation/move_collision.h"

#include <fmt/format.h>

#include <algorithm>

namespace condyle {
namespace {

ClinicalMove scaled(ClinicalMove move, double fraction) {
  for (double* value : {&move.left_mm, &move.forward_mm, &move.up_mm, &move.roll_deg,
                        &move.pitch_deg, &move.yaw_deg})
    *value *= fraction;
  return move;
}

}  // namespace

std::optional<MoveCollision> move_collision(const Operated& operated, const Plan& plan,
                                            const MoveStep& step) {
  const auto* whole = std::get_if<ClinicalMove>(&step.move);
  if (!whole) return std::nullopt;
  const auto overlaps = segment_overlaps(operated, step.segment);
  const auto hit =
      std::find_if(overlaps.begin(), overlaps.end(), [](const SegmentOverlap& overlap) {
        return overlap.kind == SegmentOverlap::Kind::collision;
      });
  if (hit == overlaps.end()) return std::nullopt;
  MoveCollision found;
  found.free_fraction = free_fraction(operated, step.segment, [&](double fraction) {
    return planned_pose(operated, plan, {step.segment, scaled(*whole, fraction)});
  });
  found.free = scaled(*whole, found.free_fraction);
  found.words = fmt::format(
      "{}; {:.0f} % of the move is free: {}", overlap_text(*hit, present_landmarks(operated)),
      100 * found.free_fraction, found.free_fraction > 0 ? move_words(found.free) : "nothing");
  return found;
}

}  // namespace condyle
