#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/contact/contact.h"
#include "sim/motion/movements.h"

namespace condyle {

/// Opening of this jaw: the coupling of rotation and translation that its bones permit, as close to
/// an initial hinge as possible, and its extent: the requested descent of the incisal point, else
/// the mean displacement in adults. Appends to `notes`. source: coupling after Leader 2003 (1.5
/// deg/mm) and Travers 2000; displacement after Woelfel (51.2 mm), where the joint is estimated
/// after Travers (46.6 mm). throws: InputError when the requested opening needs too large a
/// rotation.
/// `progress`: an exception from it cancels.
OpeningLimits opening_limits(const JawJoints& joints, const ContactModel& contacts,
                             const MotionParameters& parameters, std::vector<std::string>& notes,
                             const Progress& progress = {});

/// Whether bones other than teeth that are apart at rest are apart at the pose.
bool bones_free(const Case& patient, const ContactModel& contacts, const Pose& X_CM);

}  // namespace condyle
