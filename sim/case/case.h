#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/math/pose.h"
#include "sim/case/canal.h"
#include "sim/case/condylar_path.h"
#include "sim/case/face_muscle.h"
#include "sim/case/jaw_mechanics.h"
#include "sim/case/landmarks.h"
#include "sim/case/motion_parameters.h"
#include "sim/case/muscle.h"
#include "sim/case/source_frame.h"
#include "sim/case/tissue_plan.h"
#include "sim/frame/body_tree.h"
#include "sim/frame/pair_rule.h"
#include "sim/frame/part.h"

namespace condyle {

/// A patient at rest, ready to simulate: DICOM LPS, mm.
struct Case {
  std::string name;
  BodyTree bodies = native_bodies();
  JawBodies jaw;
  std::vector<Part> parts;
  Landmarks landmarks;
  std::optional<CondylarPath> condylar_path;  // when the joint's own path is known
  SourceFrame source;                         // of the files that it was imported from
  std::vector<std::string> notes;             // results of the import, for people
  TissuePlan tissue;                          // deviations of its soft tissue from the default

  std::vector<PairRule> pair_rules;  // deviations from the default rules; the last match
                                     // applies
  MotionParameters motion;           // deviations of its motion from the default

  // Scanned with the mouth open: descent of the lower incisal point from the closed position to the
  // rest pose, where declared (0: closed at rest); else it is found from the teeth.
  std::optional<double> scan_opening_mm = std::nullopt;
  // The closed position, from which openings count: X_CM. Found by make_scene(), not stored.
  Pose X_CM_closed = {};

  std::vector<Muscle> muscles = {};           // empty: default muscles fitted to its landmarks
  std::vector<FaceMuscle> face_muscles = {};  // of expression; empty: default ones likewise
  std::optional<JawMechanics> mechanics = std::nullopt;  // where measured
  std::vector<Canal> canals = {};                        // that cuts must avoid, where known
  // The mandible in the bite that was scanned with the dental arches, where there is one.
  std::optional<Pose> X_CM_bite = std::nullopt;

  const Part* find(Role role) const {
    for (const auto& part : parts)
      if (part.role == role) return &part;
    return nullptr;
  }
  /// The first part of this role on a body, such as the maxilla of jaw.upper_arch.
  const Part* find(Role role, BodyId body) const {
    for (const auto& part : parts)
      if (part.role == role && part.body == body) return &part;
    return nullptr;
  }
  /// The teeth that a body carries; null where it has none.
  const Part* teeth_of(BodyId body) const {
    for (const auto& part : parts)
      if (is_teeth(part.role) && part.body == body) return &part;
    return nullptr;
  }
  /// Whether both arches of the jaw have teeth.
  bool has_both_arches() const { return teeth_of(jaw.upper_arch) && teeth_of(jaw.lower_arch); }
  bool has_parts(BodyId body) const {
    for (const auto& part : parts)
      if (part.body == body) return true;
    return false;
  }
  /// Appends a part with its own body of the same name. Returns the body.
  /// throws: InputError as BodyTree::add().
  BodyId add_piece(Part part, BodyId parent, BodyDriver driver = BodyDriver::hand);
};

}  // namespace condyle
