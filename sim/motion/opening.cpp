#include "sim/motion/opening.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/error.h"
#include "sim/motion/condylar_path.h"
#include "sim/motion/joint_surfaces.h"

namespace condyle {
namespace {

constexpr double known_joint_way_mm = 51.2;  // mean of adults, Woelfel
constexpr double imported_way_mm = 46.6;     // a joint that was only guessed is asked for less
constexpr double largest_rotation = 45 * radian_per_degree;
constexpr double give_way_mm = 0.5;     // opening given up where bone is met, so that it is not
constexpr double least_opening_mm = 5;  // of a jaw; met earlier, contact shall show where

/// How far the lower incisal point shall go: the drop that was asked for, else an adult's way.
struct Wanted {
  bool drop;
  double mm;

  const char* word() const { return drop ? "drop" : "way"; }
};

/// A symmetric opening, by rotation.
struct OpeningPath {
  const JawJoints& joints;
  Coupling coupling;

  JawInputs inputs(double theta) const {
    const double forward = coupling.forward_mm(theta);
    return {theta, forward, forward, 0};
  }
  double drop_mm(double theta) const { return joints.opening_mm(inputs(theta)); }
  double way_mm(double theta) const {
    return (joints.incisor(inputs(theta)) - joints.incisor()).norm();
  }
  double gone_mm(double theta, const Wanted& wanted) const {
    return wanted.drop ? drop_mm(theta) : way_mm(theta);
  }

  /// Rotation at which the incisal point has gone as far as wanted; at most the largest rotation.
  double theta_for(const Wanted& wanted) const {
    if (gone_mm(largest_rotation, wanted) <= wanted.mm) return largest_rotation;
    double low = 0, high = largest_rotation;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (gone_mm(middle, wanted) < wanted.mm ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
};

/// Every pair at most as deep as at rest, and pairs that were apart still apart.
bool is_free(const ContactSet& now, const ContactSet& rest) {
  for (std::size_t i = 0; i < now.pairs.size(); ++i)
    if (now.pairs[i].touching &&
        (!rest.pairs[i].touching || now.pairs[i].depth_mm > rest.pairs[i].depth_mm + 0.02))
      return false;
  return true;
}

/// A condyle that comes much nearer to its fossa than at rest would crush the disc: nearer than
/// `least` tells, of the rest gap.
bool crushes(const JawJoints& joints, const Pose& X_CM, double least, TrianglePair& left,
             TrianglePair& right) {
  if (!joints.surfaces()) return false;
  const JointSurfaces& joint = *joints.surfaces();
  return joint.gap_mm(JawSide::left, X_CM, left) < least * joint.rest_gap_mm(JawSide::left) ||
         joint.gap_mm(JawSide::right, X_CM, right) < least * joint.rest_gap_mm(JawSide::right);
}

/// The largest rotation up to `end` that is reached without bone meeting bone.
double free_rotation(const OpeningPath& path, double end, double least_gap,
                     const ContactModel& contacts) {
  constexpr int steps = 120;
  ContactSet last = contacts.at_rest();
  TrianglePair left, right;
  for (int i = 1; i <= steps; ++i) {
    const Pose X_CM = path.joints.pose(path.inputs(end * i / steps));
    if (crushes(path.joints, X_CM, least_gap, left, right)) return end * (i - 1) / steps;
    last = contacts.find(X_CM, &last, 2);
    if (!is_free(last, contacts.at_rest())) return end * (i - 1) / steps;
  }
  return end;
}

std::vector<Coupling> couplings_to_try(const MotionParameters& parameters) {
  Coupling usual;
  if (parameters.hinge_deg) usual.hinge = *parameters.hinge_deg * radian_per_degree;
  std::vector<Coupling> all;
  if (parameters.early_translation) {
    usual.early = *parameters.early_translation;
    return {usual};
  }
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    all.push_back(usual);
    all.back().early = share;
  }
  for (const double degrees : {1.25, 1.0, 2.0, 3.0}) {
    all.push_back(usual);
    all.back().rad_per_mm = degrees * radian_per_degree;
    all.back().early = 1;
  }
  return all;
}

}  // namespace

bool bones_free(const Case& patient, const ContactModel& contacts, const Pose& X_CM) {
  const ContactSet now = contacts.find(X_CM, &contacts.at_rest(), 2);
  for (std::size_t i = 0; i < now.pairs.size(); ++i) {
    const PairContact& pair = now.pairs[i];
    const auto teeth = [&](int part) {
      return is_teeth(patient.parts[static_cast<std::size_t>(part)].role);
    };
    if (pair.touching && !contacts.at_rest().pairs[i].touching && !teeth(pair.part_a) &&
        !teeth(pair.part_b))
      return false;
  }
  return true;
}

OpeningLimits opening_limits(const JawJoints& joints, const ContactModel& contacts,
                             const MotionParameters& parameters, std::vector<std::string>& notes) {
  const auto& asked = parameters.opening_mm;
  const Wanted wanted =
      asked ? Wanted{true, *asked}
            : Wanted{false, joints.well_known() ? known_joint_way_mm : imported_way_mm};
  // A gap that thins along the way is meant to.
  const double least_gap = joints.well_known() ? 0.3 : 0.7;
  // The first coupling that reaches the wanted opening freely, else the one that opens farthest.
  struct Choice {
    Coupling coupling;
    double end = 0, free_end = 0, free_mm = 0;
  };
  std::optional<Choice> best;
  for (const Coupling& coupling : couplings_to_try(parameters)) {
    const OpeningPath path{joints, coupling};
    Choice choice{coupling, path.theta_for(wanted)};
    choice.free_end = free_rotation(path, choice.end, least_gap, contacts);
    choice.free_mm = path.gone_mm(choice.free_end, wanted);
    if (!best || choice.free_mm > best->free_mm + 1e-9) best = choice;
    if (choice.free_end == choice.end && choice.free_mm > wanted.mm - 1e-6) break;
  }
  const OpeningPath path{joints, best->coupling};
  const double largest = path.gone_mm(best->end, wanted);
  if (asked && largest < wanted.mm - 1e-6)
    throw InputError(
        fmt::format("opening {:.6g} mm: this jaw opens to {:.1f} mm when it turns by 45 "
                    "degrees; ask for less",
                    wanted.mm, largest));
  double end = best->end;
  if (best->free_end < best->end) {
    const bool keeps_clear = !asked && best->free_mm > least_opening_mm;
    notes.push_back(fmt::format(
        "bone meets bone where the incisal point has gone {:.1f} mm ({}) of the {:.1f} mm "
        "wanted{}",
        best->free_mm, wanted.word(), wanted.mm,
        keeps_clear ? "" : ", which is tried all the same"));
    if (keeps_clear)
      end = path.theta_for({wanted.drop, std::max(best->free_mm - give_way_mm, 0.0)});
  }
  const double forward = best->coupling.forward_mm(end);
  notes.push_back(fmt::format(
      "maximum opening: the incisal point drops by {:.1f} mm and goes {:.1f} mm; rotation {:.1f} "
      "deg, condyles {:.1f} mm forward and {:.1f} mm down, early translation {:.2f}, {:.2f} "
      "deg/mm; {}",
      path.drop_mm(end), path.way_mm(end), end / radian_per_degree, forward,
      joints.drop_mm(JawSide::left, forward, end), best->coupling.early,
      best->coupling.rad_per_mm / radian_per_degree, joints.guide()));
  return {best->coupling, end};
}

}  // namespace condyle
