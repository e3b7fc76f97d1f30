#pragma once

#include "engine/tissue/spring_prism.h"

namespace condyle {

struct EquilibriumSettings {
  double max_strain = 0.5;  // |l - l0| / l of any spring whose strain is chosen; below 1
  int rounds = 30;
};

/// What balancing gave. Forces in N of the springs' own (without the factor lambda).
struct Equilibrium {
  Nodes anchor_offset;           // mm; to add to each anchor's target, turned as its bone turns
  double force_before = 0;       // largest force on a node that was to be balanced
  double force_after = 0;        // the largest that is left
  double max_strain = 0;         // of the springs whose strain was chosen
  double max_volume_strain = 0;  // |v0 - v| / v of any prism
  int at_bound = 0;              // springs at EquilibriumSettings::max_strain
  double rest_energy = 0;        // mJ, at x: what later energies are told relative to
};

/// Chooses strains of all springs but those of the outermost sheet, pressures of the prisms and
/// offsets of the anchors, so that no node feels a force at `x` under `loads`: the model does not
/// move before surgery. Of all such strains, those of least energy within the bound; what cannot be
/// balanced is left and told. `loads.anchor_target` are the targets before the offsets. Changes
/// net.rest_length and net.rest_volume.
Equilibrium balance_strains(SpringPrismNet& net, const NetLoads& loads, const Nodes& x,
                            const EquilibriumSettings& settings = {});

}  // namespace condyle
