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

Plan without_move(Plan plan, const std::string& segment) {
  std::erase_if(plan.steps, [&](const PlanStep& step) {
    const auto* move = std::get_if<MoveStep>(&step.action);
    return move && move->segment == segment;
  });
  return plan;
}

}  // namespace

SegmentBite find_segment_bite(const Case& patient, const Plan& plan, const std::string& segment,
                              OcclusionSettings settings, const Progress& progress,
                              SegmentBiteStart start) {
  if (start == SegmentBiteStart::scanned && !patient.X_CM_bite)
    throw InputError(
        "the case holds no scanned bite; import dental scans in occlusion with condyle "
        "import teeth");
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
  // Each arch was moved by the plan from where the scanned bite relates them.
  found.start = start == SegmentBiteStart::normal
                    ? normal_relation(find_arches(planned))
                    : operated.poses[jaw.upper_arch] * *patient.X_CM_bite *
                          operated.poses[jaw.lower_arch].inverse();
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
