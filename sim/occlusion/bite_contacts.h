#pragma once

#include <vector>

#include "sim/occlusion/close_bite.h"

namespace condyle {

/// Marks on the articulating film at a pose: connected loaded patches of one pair of teeth, in
/// order of decreasing load. Marks below 0.02 mm^2 are omitted.
std::vector<ToothContact> find_contacts(const Arches& arches, const BiteModel& model,
                                        const Pose& X_CM);

/// Load of each separate tooth, by FDI number, including teeth without contact.
std::vector<ToothLoad> tooth_loads(const Arches& arches, const std::vector<ToothContact>& contacts);

/// FDI number of the tooth that a triangle of the part belongs to; 0 where teeth are not separate.
int tooth_of(const Part& part, int triangle);

}  // namespace condyle
