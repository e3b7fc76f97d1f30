#pragma once

#include <string>

#include "sim/frame/body_poses.h"
#include "sim/occlusion/occlusion.h"
#include "sim/plan/plan.h"

namespace condyle {

/// A segment placed by the final bite.
struct SegmentBite {
  Case patient;       // as planned but for the segment, which is at rest
  BodyPoses at;       // of it, with the segment in the bite
  Pose X_CS;          // of the segment, from the uncut rest
  Bite bite;          // of the lower arch on the upper one, at the planned positions of all else
  Pose start;         // of the lower arch, from which the bite was closed
  bool lower = true;  // the segment carries the lower arch, not the upper one
};

/// The relation of the arches from which a segment's bite is closed.
enum class SegmentBiteStart {
  normal,  // normal overjet and overbite, common midline, parallel occlusal planes
  scanned  // the bite that was scanned with the dental arches (Case::X_CM_bite)
};

/// Sets the segment that carries an arch into maximum intercuspation with the other arch, which
/// lies as planned; no joint holds it. The segment's own move in the plan is ignored. throws:
/// InputError as apply_plan(), for a segment without an arch, a segment that carries both condyles,
/// for a case without the scanned bite that is asked for, and as BiteFinder.
SegmentBite find_segment_bite(const Case& patient, const Plan& plan, const std::string& segment,
                              OcclusionSettings settings = {}, const Progress& progress = {},
                              SegmentBiteStart start = SegmentBiteStart::normal);

/// The plan with the segment's move set to X_CS of the bite.
Plan with_segment_bite(Plan plan, const std::string& segment, const SegmentBite& found);

}  // namespace condyle
