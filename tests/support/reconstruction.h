#pragma once

#include "sim/plan/plan.h"

namespace condyle::test {

/// A segment of the jaw resected between teeth (FDI numbers).
inline Plan resection_plan(const Case& patient, int from_tooth = 34, int to_tooth = 37) {
  Plan plan;
  plan.name = "reconstruction";
  plan.geometry = geometry_of(patient);
  plan = with_step(std::move(plan),
                   CutStep{.osteotomy = "segmental_resection",
                           .parameters = {{"from_tooth", from_tooth}, {"to_tooth", to_tooth}},
                           .kerf_mm = 0.5,
                           .pieces = {"tumour"},
                           .below_margins = true});
  return with_step(std::move(plan), ResectStep{"tumour"});
}

/// A fibula in its place.
inline GraftStep fibula_graft(int pieces) {
  GraftStep step;
  step.name = "fibula";
  step.replaces = "tumour";
  step.pieces = pieces;
  return step;
}

}  // namespace condyle::test
