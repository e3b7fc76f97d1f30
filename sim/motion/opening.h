#pragma once

#include "sim/motion/motion.h"

namespace condyle {

/// Opens the jaw and closes it again: the mandible turns about the line through its condyles while
/// both move forward and down along the condylar path. Needs the landmarks left_condyle,
/// right_condyle and lower_incisal_point.
/// source: the coupling of rotation and translation after Leader 2003 (1.5 deg/mm) and Travers
/// 2000.
Motion make_opening(const Case& patient, const ContactModel& contacts,
                    const OpeningSettings& settings);

}  // namespace condyle
