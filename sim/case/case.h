#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/case/condylar_path.h"
#include "sim/case/jaw_mechanics.h"
#include "sim/case/landmarks.h"
#include "sim/case/motion_parameters.h"
#include "sim/case/muscle.h"
#include "sim/case/tissue_plan.h"
#include "sim/frame/pair_rule.h"
#include "sim/frame/part.h"

namespace condyle {

/// A patient at rest, ready to simulate: DICOM LPS, mm.
struct Case {
  std::string name;
  std::vector<Part> parts;
  Landmarks landmarks;
  std::optional<CondylarPath> condylar_path;  // when the joint's own path is known
  std::string source_units = "mm";            // as declared at import
  std::string source_frame = "LPS";
  std::vector<std::string> notes;  // what import found and did, for people
  TissuePlan tissue;               // how its soft tissue differs from the usual

  std::vector<PairRule> pair_rules;  // where they differ from the usual ones; the last that fits
                                     // counts
  MotionParameters motion;           // where the jaw moves otherwise than usual

  std::vector<Muscle> muscles = {};  // none: usual ones are put to its landmarks
  std::optional<JawMechanics> mechanics = std::nullopt;  // where measured

  const Part* find(Role role) const {
    for (const auto& part : parts)
      if (part.role == role) return &part;
    return nullptr;
  }
  bool has(Body body) const {
    for (const auto& part : parts)
      if (body_of(part.role) == body) return true;
    return false;
  }
};

}  // namespace condyle
