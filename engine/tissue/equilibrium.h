#pragma once

#include "engine/tissue/spring_prism.h"

namespace condyle {

/// How much strain may be chosen. What these bounds do not allow, a constant force holds.
struct EquilibriumSettings {
  double max_pull = 0.9;    // (l - l0) / l of any spring whose strain is chosen; below 1
  double max_push = 0.5;    // (l0 - l) / l: shortened more, tissue buckles of itself
  double max_volume = 0.5;  // |v0 - v| / v of any prism; below 1
  int rounds = 40;          // of Newton's method
  int attempts = 10;        // to find a state that is stable
};

/// What balancing gave. Forces in N of the springs' own (without the factor lambda).
struct Equilibrium {
  Nodes anchor_offset;           // mm; to add to each anchor's target, turned as its bone turns
  Nodes held;                    // to add to NetLoads::node_force; empty when nothing is left
  double force_before = 0;       // largest force on a node that was to be balanced
  double force_held = 0;         // the largest that strains could not balance: of `held`
  int nodes_held = 0;            // that have a hundredth of it and more
  double force_after = 0;        // the largest that is left with all of that
  double max_strain = 0;         // of the springs whose strain was chosen
  double max_volume_strain = 0;  // |v0 - v| / v of any prism
  int at_bound = 0;              // springs and prisms at their bounds
  bool stable = false;           // comes back when it is shaken
  double rest_energy = 0;        // mJ, at x: what later energies are told relative to
};

/// Chooses strains of all springs but those of the outermost sheet, pressures of the prisms and
/// offsets of the anchors, so that no node feels a force at `x` under `loads`: the model does not
/// move before surgery. Of all such strains, those of least energy within the bounds; what is left
/// is held by constant forces, and told. Where prestress would make the state unstable (it would
/// stay, but not come back when shaken; slivers buckle of hardly any) none is chosen there.
/// `loads.anchor_target` are the targets before the offsets. Changes net.rest_length and
/// net.rest_volume.
Equilibrium balance_strains(SpringPrismNet& net, const NetLoads& loads, const Nodes& x,
                            const EquilibriumSettings& settings = {});

}  // namespace condyle
