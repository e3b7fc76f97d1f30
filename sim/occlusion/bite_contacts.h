#pragma once

#include <vector>

#include "sim/occlusion/settle.h"

namespace condyle {

/// The marks on the paper at a pose: pressed pieces that hang together, of one pair of teeth.
/// Largest share of the load first. Marks below 0.02 mm^2 are left out.
std::vector<ToothContact> find_contacts(const Arches& arches, const BiteModel& model,
                                        const Pose& X_CM);

/// What each separate tooth bears, by FDI number; teeth without contact are there, too.
std::vector<ToothLoad> tooth_loads(const Arches& arches, const std::vector<ToothContact>& contacts);

/// FDI number of the tooth that a triangle of the part belongs to; 0 where teeth are not separate.
int tooth_of(const Part& part, int triangle);

}  // namespace condyle
