#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/contact/contact.h"
#include "sim/motion/movements.h"

namespace condyle {

/// How this jaw opens: the coupling of rotation and translation that its bones leave free, as near
/// to a hinge first as they do, and how far: to the drop that is asked for, else until the incisal
/// point has gone as far as in adults. Notes tell people.
/// source: the coupling after Leader 2003 (1.5 deg/mm) and Travers 2000; the way after Woelfel
/// (51.2 mm), in patients whose joint is a guess after Travers (46.6 mm).
/// throws: InputError when the opening that is asked for needs too large a rotation.
OpeningLimits opening_limits(const JawJoints& joints, const ContactModel& contacts,
                             const MotionParameters& parameters, std::vector<std::string>& notes);

/// Whether bones that are apart at rest, teeth aside, are apart at the pose.
bool bones_free(const Case& patient, const ContactModel& contacts, const Pose& X_CM);

}  // namespace condyle
