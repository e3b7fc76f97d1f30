#pragma once

#include "engine/tissue/spring_prism.h"

namespace condyle {

/// Bounds of the prestrain. Constant forces hold what the bounds do not allow.
struct EquilibriumSettings {
  double max_pull = 0.9;    // (l - l0) / l of any spring with chosen strain; below 1
  double max_push = 0.5;    // (l0 - l) / l: beyond this tissue buckles
  double max_volume = 0.5;  // |v0 - v| / v of any prism; below 1
  int rounds = 40;          // of Newton's method
  int attempts = 10;        // to find a stable state
};

/// Result of balancing. Forces in N without the factor lambda.
struct Equilibrium {
  Nodes anchor_offset;           // mm; to be added to each anchor's target, rotated with its bone
  Nodes held;                    // to be added to MeshLoads::node_force; empty when zero
  double force_before = 0;       // largest unbalanced force on a node before
  double force_held = 0;         // largest force that strains could not balance, in `held`
  int nodes_held = 0;            // number with at least a hundredth of it
  double force_after = 0;        // largest remaining force
  double max_strain = 0;         // of the springs with chosen strain
  double max_volume_strain = 0;  // |v0 - v| / v of any prism
  int at_bound = 0;              // springs and prisms at their bounds
  bool stable = false;           // returns to rest after a perturbation
  double rest_energy = 0;        // mJ, at x: reference of later energies
};

/// Chooses strains of all springs but those of the outermost sheet, pressures of the prisms and
/// offsets of the anchors, so that the force on every node is zero at `x` under `loads`: the model
/// does not move before surgery. Among such strains, those of least energy within the bounds;
/// constant forces hold the remainder, which is reported. Where prestress would make the state
/// unstable (slivers buckle under very little) none is chosen. `loads.anchor_target`: targets
/// without the offsets. Changes mesh.rest_length and mesh.rest_volume.
Equilibrium balance_strains(SpringPrismMesh& mesh, const MeshLoads& loads, const Nodes& x,
                            const EquilibriumSettings& settings = {});

}  // namespace condyle
