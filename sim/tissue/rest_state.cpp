#include "sim/tissue/rest_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "engine/tissue/equilibrium.h"
#include "engine/tissue/own_stiffness.h"

namespace condyle {

void balance(TissueMesh& mesh, TissueModel& model) {
  const Equilibrium balanced = balance_strains(mesh.elements, loads_at(model, {}), mesh.rest);
  model.support.anchor_offset = balanced.anchor_offset;
  if (!balanced.stable)
    model.summary.notes.push_back(
        "with this skin pretension (turgor) and weight the tissue is unstable at rest: turgor "
        "closer to 1 or more layers are more stable");
  model.support.held_force = balanced.held;
  if (balanced.held.empty()) return;
  constexpr double noted_N = 1e-4;
  if (balanced.force_held < noted_N) return;
  model.summary.notes.push_back(
      fmt::format("strains alone cannot balance skin pretension and weight everywhere: constant "
                  "forces of up to "
                  "{:.2g} N hold the rest at {} of {} points",
                  balanced.force_held, balanced.nodes_held, mesh.rest.size()));
}

void prepare_elements(TissueMesh& mesh) {
  mesh.runs = std::make_shared<const ElementBatches>(mesh.elements);
  mesh.own_stiffness = own_stiffness(mesh.elements, mesh.rest);
}

void measure_rest(TissueModel& model, int threads) {
  const TissueMesh& mesh = *model.mesh;
  TissueSummary& summary = model.summary;
  Nodes force;
  MeshLoads loads = contact_loads(model, {}, mesh.rest);
  SpringPrismEnergy(mesh.elements, loads, 1).value_and_gradient(mesh.rest, force);
  for (const auto& f : force) summary.rest_force_N = std::max(summary.rest_force_N, f.norm());
  TissueBudget budget;
  budget.tolerance_mm = 1e-6;
  budget.threads = threads;
  const TissueState still = solve_tissue(model, rest_tissue(model), {}, budget);
  summary.rest_move_mm = largest_displacement(mesh.rest, still.nodes);
  if (still.reused || !still.converged)
    summary.notes.push_back("the unmoved tissue could not be solved: it may move without a load");
  else if (summary.rest_move_mm > 1e-4)
    summary.notes.push_back("the unmoved tissue moves by " + std::to_string(summary.rest_move_mm) +
                            " mm: skin pretension and weight could not be balanced everywhere");
  summary.lip_points_left_out = model.contact->lip_points_left_out;
  summary.rest_overlap_mm = overlap_at_rest(*model.contact);
  constexpr double plausible_mm = 4;  // real faces in place: up to 2.8
  if (summary.rest_overlap_mm > plausible_mm)
    summary.notes.push_back(fmt::format(
        "tissue lies up to {:.1f} mm deep in bone, teeth or the other lip at rest; this overlap "
        "is allowed. Are face and bones of the same patient, in the same frame?",
        summary.rest_overlap_mm));
}

}  // namespace condyle
