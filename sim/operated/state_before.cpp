#include "sim/operated/state_before.h"

#include <algorithm>

namespace condyle {
namespace {

/// What remains of a kind of part where some was resected, else of its bone.
std::string shown_with(const Operated& operated, const Resection& resection, Role role) {
  for (const Part& part : operated.patient.parts)
    if (part.role == role && role != Role::segment) return part.name;
  for (const Part& part : operated.patient.parts)
    if (const auto origin = operated.origin.find(part.name);
        origin != operated.origin.end() && origin->second.part == resection.origin.part)
      return part.name;
  return {};
}

}  // namespace

std::optional<BeforeOperation> before_operation(const Operated& operated, const FrameState& at_rest,
                                                const Case& uncut) {
  const auto& planned = operated.poses.X_CB;
  BeforeOperation before;
  for (const Resection& resection : operated.resections)
    for (Part part : resection.parts) {
      part.body = cranium_body;
      std::string shown_as = shown_with(operated, resection, part.role);
      before.removed.push_back({std::move(part), std::move(shown_as)});
    }
  for (const GraftLayout& graft : operated.grafts)
    for (const GraftPiece& piece : graft.pieces)
      for (const Part& part : operated.patient.parts)
        if (operated.patient.bodies[part.body].name == piece.body)
          before.added.push_back(part.name);
  const Pose rest;
  if (before.removed.empty() && before.added.empty() &&
      std::all_of(planned.begin(), planned.end(),
                  [&](const Pose& X) { return bit_identical(X, rest); }))
    return std::nullopt;
  FrameState& frame = before.frame;
  frame = at_rest;
  frame.contacts = {};
  for (std::size_t b = 0; b < std::min(planned.size(), frame.poses.X_CB.size()); ++b)
    frame.poses.X_CB[b] = planned[b].inverse();
  if (const Part* face = uncut.find(Role::face)) {
    frame.face.clear();
    for (const Eigen::Vector3d& p : face->mesh.vertices) frame.face.push_back(p.cast<float>());
  }
  return before;
}

}  // namespace condyle
