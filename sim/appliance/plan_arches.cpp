#include "sim/appliance/plan_arches.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "engine/core/error.h"
#include "sim/appliance/grid_frame.h"
#include "sim/occlusion/arches.h"
#include "sim/operation/closed_bone.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// The teeth of a jaw in one mesh, which may be several parts; else the bone that carries crowns.
SplintArch splint_arch(const Case& patient, const Arch& arch, Role teeth,
                       std::vector<std::string>& notes) {
  SplintArch made{arch.part->name, {}, arch.edge, arch.molars};
  const auto add = [&](const Part& part) {
    const ClosedBone closed = closed_bone(part);
    for (const std::string& note : closed.notes) notes.push_back(note);
    append(made.mesh, closed.mesh);
  };
  if (!is_teeth(arch.part->role)) {
    add(*arch.part);
    return made;
  }
  for (const Part& part : patient.parts)
    if (part.role == teeth && !part.mesh.empty()) add(part);
  return made;
}

}  // namespace

bool moves_arch(const Operated& operated, bool upper) {
  const JawBodies& jaw = operated.patient.jaw;
  return !bit_identical(operated.poses[upper ? jaw.upper_arch : jaw.lower_arch], {});
}

Case patient_at_stage(const Operated& operated, SplintKind kind, FirstJaw first) {
  if (kind == SplintKind::final_bite) return operated_case(operated);
  Operated stage = operated;
  const BodyTree& bodies = operated.patient.bodies;
  for (std::size_t b = 0; b < bodies.bodies().size(); ++b) {
    const BodyId body{static_cast<int>(b)};
    const bool lower = bodies.is_within(body, mandible_body);
    if (lower == (first == FirstJaw::upper)) stage.poses[body] = {};
  }
  return operated_case(stage);
}

SplintArches splint_arches(const Operated& operated, SplintKind kind, FirstJaw first) {
  if (!operated.problems.empty())
    throw InputError(
        fmt::format("the plan cannot be done: {}", fmt::join(operated.problems, "; ")));
  const bool upper = moves_arch(operated, true), lower = moves_arch(operated, false);
  if (!upper && !lower)
    throw InputError(
        "the plan moves no dental arch: a splint needs a move of the upper or lower jaw");
  if (kind == SplintKind::intermediate && !(upper && lower))
    throw InputError(fmt::format(
        "the plan moves the {} jaw alone: it needs no intermediate splint, make the final "
        "one (--kind final)",
        upper ? "upper" : "lower"));
  const Case patient = patient_at_stage(operated, kind, first);
  const Arches found = find_arches(patient);
  SplintArches arches;
  arches.upper = splint_arch(patient, found.upper, Role::upper_teeth, arches.notes);
  arches.lower = splint_arch(patient, found.lower, Role::lower_teeth, arches.notes);
  arches.condyles = found.condyles;
  return arches;
}

}  // namespace condyle
