#include "sim/operated/segment_bite.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "engine/core/error.h"
#include "sim/occlusion/arches.h"
#include "sim/operation/operation.h"

namespace condyle {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Normal incisors, mm; the norms of cephalometry.cpp.
constexpr double overjet_mm = 2.5, overbite_mm = 2.5;

Plan without_move(Plan plan, const std::string& segment) {
  std::erase_if(plan.steps, [&](const PlanStep& step) {
    const auto* move = std::get_if<MoveStep>(&step.action);
    return move && move->segment == segment;
  });
  return plan;
}

/// Axes of an arch: to the left molar, back and up in its occlusal plane.
Matrix3d axes_of(const Arch& arch) {
  const Vector3d left = (arch.molars[0] - arch.molars[1]).normalized();
  const Vector3d back = 0.5 * (arch.molars[0] + arch.molars[1]) - arch.edge;
  const Vector3d up = left.cross(back).normalized();
  Matrix3d axes;
  axes << left, up.cross(left), up;
  return axes;
}

/// The lower arch with normal incisors under the upper one.
Pose normal_relation(const Arches& arches) {
  const Matrix3d upper = axes_of(arches.upper);
  const Matrix3d turn = upper * axes_of(arches.lower).transpose();
  const Vector3d edge = arches.upper.edge + upper * Vector3d(0, overjet_mm, overbite_mm);
  return {Eigen::Quaterniond(turn), edge - turn * arches.lower.edge};
}

}  // namespace

SegmentBite find_segment_bite(const Case& patient, const Plan& plan, const std::string& segment,
                              OcclusionSettings settings, const Progress& progress) {
  report(progress, "replaying the plan", 0);
  const Operated operated = apply_plan(patient, without_move(plan, segment));
  const BodyTree& bodies = operated.patient.bodies;
  const auto body = bodies.find(segment);
  if (!body) throw InputError(fmt::format("no step of the plan makes \"{}\"", segment));
  const JawBodies& jaw = operated.patient.jaw;
  const auto carries = [&](BodyId arch) {
    const auto all = bodies.subtree(*body);
    return std::find(all.begin(), all.end(), arch) != all.end();
  };
  const bool lower = carries(jaw.lower_arch), upper = carries(jaw.upper_arch);
  if (lower == upper)
    throw InputError(fmt::format("\"{}\" carries {}: a bite places a segment with one dental arch",
                                 segment, lower ? "both arches" : "neither arch"));
  if (lower && carries(jaw.left_condyle) && carries(jaw.right_condyle))
    throw InputError(fmt::format(
        "\"{}\" carries both condyles: split the mandible first, or see condyle occlude", segment));

  SegmentBite found;
  found.patient = operated_case(operated);
  Case planned = found.patient;
  for (const char* condyle : {"left_condyle", "right_condyle"})
    planned.landmarks.points.erase(condyle);  // no joint holds the segment
  found.lower = lower;
  found.start = normal_relation(find_arches(planned));
  found.bite = BiteFinder(planned, settings, progress).find(found.start, progress);
  const Pose& X = found.bite.rest.X_CM;
  // The segment's rest is the uncut one; its parents may have been moved with it.
  const Pose& before = operated.poses[*body];
  const Pose moved = lower ? X : X.inverse();
  found.X_CS = moved * before;
  found.at = completed(bodies, {});
  for (const BodyId each : bodies.subtree(*body)) found.at[each] = moved;
  return found;
}

Plan with_segment_bite(Plan plan, const std::string& segment, const SegmentBite& found) {
  return with_move(std::move(plan), {segment, ExplicitMove{found.X_CS}});
}

}  // namespace condyle
