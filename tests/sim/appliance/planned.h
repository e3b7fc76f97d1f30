#pragma once

#include "sim/appliance/guide.h"
#include "sim/appliance/plan_arches.h"
#include "sim/osteotomy/osteotomy.h"
#include "sim/phantom/phantom.h"
#include "sim/plan/case_geometry.h"

namespace condyle::test {

/// A built-in head, made once a program.
inline const Case& class_iii_head() {
  static const Case patient =
      builtin_patient(HeadChoice{.variant = HeadChoice::Variant::class_iii});
  return patient;
}

/// The upper jaw 4 mm forward and 2 mm up, the lower one 5 mm back, without a bite.
inline const Plan& two_jaw_plan() {
  static const Plan plan = [] {
    Plan made;
    made.name = "two jaws";
    made.geometry = geometry_of(class_iii_head());
    made = with_step(made, CutStep{.osteotomy = "le_fort_1", .pieces = {"maxilla"}});
    made = with_step(made, CutStep{.osteotomy = "sagittal_split",
                                   .pieces = {"proximal_left", "proximal_right", "distal"}});
    made = with_move(made, {"maxilla", ExplicitMove{{Eigen::Quaterniond::Identity(), {0, -4, 2}}}});
    return with_move(made, {"distal", ExplicitMove{{Eigen::Quaterniond::Identity(), {0, 5, 1}}}});
  }();
  return plan;
}

inline const Operated& two_jaws() {
  static const Operated operated = apply_plan(class_iii_head(), two_jaw_plan());
  return operated;
}

}  // namespace condyle::test
