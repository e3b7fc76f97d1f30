#include "tools/demo/plan_steps.h"

#include <utility>

#include "sim/operation/operation.h"
#include "sim/osteotomy/osteotomy.h"
#include "sim/plan/move_words.h"

namespace condyle {

Plan begin_plan(const Case& patient, const std::string& name, const HeadReference& reference) {
  Plan plan;
  plan.name = name;
  plan.geometry = geometry_of(patient);
  plan.reference = reference;
  return plan;
}

Plan with_cut(const Case& patient, Plan plan, CutStep step) {
  if (step.pieces.empty())
    for (const SegmentRule& rule :
         place_osteotomy(apply_plan(patient, plan).patient, step).segments)
      step.pieces.push_back(rule.name);
  return with_step(std::move(plan), std::move(step));
}

Plan with_move(Plan plan, const std::string& segment, const std::vector<std::string>& words) {
  const Landmarks& landmarks = plan.geometry.landmarks;
  MoveStep move{segment, completed_move(parse_move_words(words), segment, landmarks,
                                        clinical_frame(landmarks, plan.reference))};
  return with_step(std::move(plan), std::move(move));
}

}  // namespace condyle
