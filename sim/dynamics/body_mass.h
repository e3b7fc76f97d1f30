#pragma once

#include "engine/rigid/mass_properties.h"
#include "sim/case/case.h"

namespace condyle {

/// Mass, centre (mm) and inertia of a body in its own frame of reference: the measured values of
/// the case for the body of the lower arch, otherwise those of its bone. Crowns count only where
/// the body has no other bone. A part whose surface is open counts as a box with the mean mass of a
/// mandible of that size. source: density of whole mandibles, 1.9 g/cm3 as in published jaw models
/// throws: InputError where the body has no bone
MassProperties body_mass(const Case& patient, BodyId body);

}  // namespace condyle
