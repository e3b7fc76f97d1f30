#include "sim/session/session_patient.h"

#include <algorithm>
#include <utility>

#include "engine/core/error.h"
#include "sim/muscles/default_muscles.h"
#include "sim/operated/operated_scene.h"

namespace condyle {

Plan empty_plan(const Case& patient) {
  Plan plan;
  plan.name = "plan";
  plan.geometry = geometry_of(patient);
  return plan;
}

std::shared_ptr<const SessionPatient> make_session_patient(Case patient,
                                                           std::filesystem::path folder,
                                                           SimulatorSettings settings,
                                                           const Progress& progress,
                                                           const std::optional<Plan>& plan) {
  std::string trouble;
  const auto build = [&]() -> Scene {
    try {
      return make_scene(patient, plan, settings, progress);
    } catch (const InputError& error) {
      if (!settings.tissue) throw;
      trouble = std::string("The soft tissue is left out. ") + error.what();
      settings.tissue = false;
      return make_scene(patient, plan, settings, progress);
    }
  };
  Scene scene = build();
  auto operated =
      std::make_shared<const Operated>(apply_plan(patient, plan ? *plan : empty_plan(patient)));
  std::vector<SegmentOverlap> overlaps = segment_overlaps(*operated);
  return completed_patient({.folder = std::move(folder),
                            .scene = std::move(scene),
                            .trouble = std::move(trouble),
                            .uncut = std::make_shared<const Case>(std::move(patient)),
                            .operated = std::move(operated),
                            .overlaps = std::move(overlaps)},
                           settings.threads);
}

std::shared_ptr<const SessionPatient> completed_patient(SessionPatient patient, int threads) {
  auto made = std::make_shared<SessionPatient>(std::move(patient));
  made->at_rest = rest_frame(made->scene);
  carry_face(made->scene, made->at_rest, threads);
  try {
    made->muscles = muscles_of(made->scene.patient);
  } catch (const InputError&) {
    // They were not requested; a muscle-driven motion states what is missing.
  }
  return made;
}

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

std::optional<BeforeOperation> before_operation(const SessionPatient& patient) {
  const Operated& operated = *patient.operated;
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
  frame = patient.at_rest;
  frame.contacts = {};
  for (std::size_t b = 0; b < std::min(planned.size(), frame.poses.X_CB.size()); ++b)
    frame.poses.X_CB[b] = planned[b].inverse();
  if (const Part* face = patient.uncut->find(Role::face)) {
    frame.face.clear();
    for (const Eigen::Vector3d& p : face->mesh.vertices) frame.face.push_back(p.cast<float>());
  }
  return before;
}

}  // namespace condyle
