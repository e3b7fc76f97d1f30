#include "sim/motion/opening.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/error.h"
#include "sim/motion/condylar_kinematics.h"
#include "sim/motion/joint_surfaces.h"

namespace condyle {
namespace {

constexpr double known_joint_displacement_mm = 51.2;      // mean of adults (Woelfel)
constexpr double estimated_joint_displacement_mm = 46.6;  // where the joint is estimated (Travers)
constexpr double largest_rotation = 45 * degree;
constexpr double clearance_reserve_mm = 0.5;  // opening kept in reserve before contact of bone
constexpr double min_opening_mm = 5;  // smaller limits are ignored, so that contact stays visible

/// Target of the lower incisal point: a requested descent, else a displacement.
struct Target {
  bool drop;
  double mm;

  const char* word() const { return drop ? "vertical" : "displacement"; }
};

/// A symmetric opening, by rotation.
struct OpeningPath {
  const JawJoints& joints;
  Coupling coupling;

  JawInputs inputs(double theta) const {
    const double forward = coupling.forward_mm(theta);
    return {theta, forward, forward, 0};
  }
  double opening_mm(double theta) const { return joints.opening_mm(inputs(theta)); }
  double displacement_mm(double theta) const {
    return (joints.incisor(inputs(theta)) - joints.closed_incisor()).norm();
  }
  double travel_mm(double theta, const Target& target) const {
    return target.drop ? opening_mm(theta) : displacement_mm(theta);
  }

  /// Rotation at which the incisal point reaches the target; at most the largest rotation.
  double theta_for(const Target& target) const {
    const double widest = joints.closed_theta() + largest_rotation;
    if (travel_mm(widest, target) <= target.mm) return widest;
    double low = joints.closed_theta(), high = widest;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (travel_mm(middle, target) < target.mm ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
};

/// Whether no pair is deeper than at rest and pairs that were apart still are.
bool is_free(const ContactSet& now, const ContactSet& rest) {
  for (std::size_t i = 0; i < now.pairs.size(); ++i)
    if (now.pairs[i].touching &&
        (!rest.pairs[i].touching || now.pairs[i].depth_mm > rest.pairs[i].depth_mm + 0.02))
      return false;
  return true;
}

/// Least gaps of the condyles to their fossae, mm.
struct DiscLimits {
  double left = 0, right = 0;

  explicit DiscLimits(const JawJoints& joints) {
    if (!joints.surfaces()) return;
    // A known joint may thin its disc.
    const double fraction = joints.well_known() ? 0.3 : 0.7;
    const auto least = [&](JawSide side) {
      const DiscGap& gap = joints.disc_gap(side);
      return fraction *
             std::min({joints.surfaces()->rest_gap_mm(side), gap.seated_mm, gap.front_mm});
    };
    left = least(JawSide::left);
    right = least(JawSide::right);
  }
};

/// Whether a condyle comes so near to its fossa that it would crush the disc.
bool crushes(const JawJoints& joints, const Pose& X_CM, const DiscLimits& least) {
  if (!joints.surfaces()) return false;
  const JointSurfaces& joint = *joints.surfaces();
  return joint.nearer_than(least.left, JawSide::left, X_CM) ||
         joint.nearer_than(least.right, JawSide::right, X_CM);
}

/// The largest rotation up to `end` that is reached without contact of bone.
double free_rotation(const OpeningPath& path, double end, const DiscLimits& disc,
                     const ContactModel& contacts, const Progress& progress) {
  constexpr int steps = 120;
  for (int i = 1; i <= steps; ++i) {
    report(progress, "searching the opening that the bones permit",
           static_cast<double>(i - 1) / steps);
    const Pose X_CM = path.joints.pose(path.inputs(end * i / steps));
    if (crushes(path.joints, X_CM, disc) ||
        !is_free(contacts.find_touching(BodyPoses(X_CM), 2), contacts.at_rest()))
      return end * (i - 1) / steps;
  }
  return end;
}

std::vector<Coupling> couplings_to_try(const MotionParameters& parameters, double closed) {
  Coupling standard{.closed = closed};
  if (parameters.hinge_deg) standard.hinge = *parameters.hinge_deg * degree;
  std::vector<Coupling> all;
  if (parameters.early_translation) {
    standard.early = *parameters.early_translation;
    return {standard};
  }
  for (const double fraction : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    all.push_back(standard);
    all.back().early = fraction;
  }
  for (const double degrees : {1.25, 1.0, 2.0, 3.0}) {
    all.push_back(standard);
    all.back().rad_per_mm = degrees * degree;
    all.back().early = 1;
  }
  return all;
}

}  // namespace

bool bones_free(const Case& patient, const ContactModel& contacts, const Pose& X_CM) {
  const ContactSet now = contacts.find(with_jaw_at(patient.bodies, X_CM), &contacts.at_rest(), 2);
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
                             const MotionParameters& parameters, std::vector<std::string>& notes,
                             const Progress& progress) {
  const auto& asked = parameters.opening_mm;
  const Target target = asked
                            ? Target{true, *asked}
                            : Target{false, joints.well_known() ? known_joint_displacement_mm
                                                                : estimated_joint_displacement_mm};
  const DiscLimits disc(joints);
  // The first coupling that reaches the target freely, else the one that opens farthest.
  struct Choice {
    Coupling coupling;
    double end = 0, free_end = 0, free_mm = 0;
  };
  std::optional<Choice> best;
  for (const Coupling& coupling : couplings_to_try(parameters, joints.closed_theta())) {
    const OpeningPath path{joints, coupling};
    Choice choice{coupling, path.theta_for(target)};
    choice.free_end = free_rotation(path, choice.end, disc, contacts, progress);
    choice.free_mm = path.travel_mm(choice.free_end, target);
    if (!best || choice.free_mm > best->free_mm + 1e-9) best = choice;
    if (choice.free_end == choice.end && choice.free_mm > target.mm - 1e-6) break;
  }
  const OpeningPath path{joints, best->coupling};
  const double largest = path.travel_mm(best->end, target);
  if (asked && largest < target.mm - 1e-6)
    throw InputError(
        fmt::format("opening {:.6g} mm: this jaw opens to {:.1f} mm at 45 degrees of rotation; "
                    "request less",
                    target.mm, largest));
  double end = best->end;
  if (best->free_end < best->end) {
    const bool keeps_clear = !asked && best->free_mm > min_opening_mm;
    notes.push_back(fmt::format("bone meets bone at {:.1f} mm ({}) of the {:.1f} mm requested{}",
                                best->free_mm, target.word(), target.mm,
                                keeps_clear ? "" : "; the motion is attempted anyway"));
    if (keeps_clear)
      end = path.theta_for({target.drop, std::max(best->free_mm - clearance_reserve_mm, 0.0)});
  }
  const double forward = best->coupling.forward_mm(end);
  notes.push_back(fmt::format(
      "maximum opening {:.1f} mm (displacement of the incisal point {:.1f} mm); rotation {:.1f} "
      "deg, condyles {:.1f} mm forward and {:.1f} mm down, early translation {:.2f}, {:.2f} "
      "deg/mm; {}",
      path.opening_mm(end), path.displacement_mm(end), (end - joints.closed_theta()) / degree,
      forward, joints.inferior_translation_mm(JawSide::left, forward, end), best->coupling.early,
      best->coupling.rad_per_mm / degree, joints.guide()));
  return {best->coupling, end};
}

}  // namespace condyle
