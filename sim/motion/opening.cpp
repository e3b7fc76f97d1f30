#include "sim/motion/opening.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "engine/core/error.h"
#include "sim/motion/condylar_path.h"
#include "sim/motion/joint_surfaces.h"

namespace condyle {
namespace {

constexpr double known_joint_opening_mm = 50;  // adults open 49 to 51 mm
constexpr double imported_opening_mm = 45;     // a joint that was only guessed is asked for less
constexpr double largest_rotation = 45 * radian_per_degree;
constexpr double give_way_mm = 0.5;  // opening given up where bone is met

// Share of the time for opening and for closing; the rest is a pause between them.
constexpr double stroke_share = 0.45;

/// Poses of the mandible by opening rotation.
struct OpeningPath {
  Eigen::Vector3d center, axis;  // of the line through the condyles; axis to the left
  Eigen::Vector3d incisor;
  Coupling coupling;
  Pchip drop_mm;           // of the condyles, by forward travel
  const char* guide = "";  // where that comes from, for people

  Pose at(double theta) const {
    const double forward = coupling.forward_mm(theta);
    const Eigen::Quaterniond R(Eigen::AngleAxisd(theta, axis));
    return {R, center - R * center + Eigen::Vector3d(0, -forward, -drop_mm(forward))};
  }
  double opening_mm(double theta) const { return incisor.z() - (at(theta) * incisor).z(); }

  /// Rotation at which the incisal point has dropped by `wanted_mm`; at most the largest rotation.
  double theta_for(double wanted_mm) const {
    if (opening_mm(largest_rotation) <= wanted_mm) return largest_rotation;
    double low = 0, high = largest_rotation;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (opening_mm(middle) < wanted_mm ? low : high) = middle;
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

/// The largest rotation up to `end` that is reached without bone meeting bone.
double free_rotation(const OpeningPath& path, double end, const ContactModel& contacts,
                     std::optional<JointSurfaces>& joint) {
  constexpr int steps = 120;
  ContactSet last = contacts.at_rest();
  for (int i = 1; i <= steps; ++i) {
    const Pose X_CM = path.at(end * i / steps);
    // A condyle that comes much nearer to its fossa than at rest would crush the disc.
    if (joint && joint->slack_mm(X_CM) < -0.3 * joint->rest_gap_mm()) return end * (i - 1) / steps;
    last = contacts.find(X_CM, &last, 2);
    if (!is_free(last, contacts.at_rest())) return end * (i - 1) / steps;
  }
  return end;
}

struct Choice {
  OpeningPath path;
  double end = 0, free_end = 0;  // rotations
};

/// Tries the couplings in order of preference; the first that reaches the wanted opening freely, or
/// else the one that opens farthest.
Choice choose(OpeningPath path, const Case& patient, const ContactModel& contacts,
              const std::vector<Coupling>& couplings, double wanted_mm) {
  std::optional<JointSurfaces> joint;
  if (!patient.condylar_path) joint = JointSurfaces::find(patient);
  std::optional<Choice> best;
  for (const Coupling& coupling : couplings) {
    path.coupling = coupling;
    if (patient.condylar_path) {
      path.drop_mm = known_path(*patient.condylar_path);
      path.guide = "along the patient's own condylar path";
    } else if (joint) {
      path.drop_mm = seated_path(*joint, path.center, path.axis, coupling);
      path.guide = "condyles keep their rest gap to the cranium";
    } else {
      path.drop_mm = average_path();
      path.guide = "along an average condylar path, for want of a fossa";
    }
    Choice choice{path, path.theta_for(wanted_mm), 0};
    choice.free_end = free_rotation(path, choice.end, contacts, joint);
    if (!best || path.opening_mm(choice.free_end) > best->path.opening_mm(best->free_end) + 1e-9)
      best = choice;
    if (choice.free_end == choice.end && path.opening_mm(choice.end) > wanted_mm - 1e-6) break;
  }
  return *best;
}

/// 0 to 1 with neither speed nor acceleration at the ends (least jerk).
double smooth_step(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10 + u * (-15 + 6 * u));
}

double progress(double u) {
  return std::min(smooth_step(u / stroke_share), smooth_step((1 - u) / stroke_share));
}

std::vector<Coupling> couplings_to_try(double early) {
  if (early >= 0) return {{.early = early}};
  std::vector<Coupling> all;
  for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0}) all.push_back({.early = share});
  for (const double degrees : {1.25, 1.0, 2.0, 3.0})
    all.push_back({.rad_per_mm = degrees * radian_per_degree, .early = 1});
  return all;
}

}  // namespace

Motion make_opening(const Case& patient, const ContactModel& contacts,
                    const OpeningSettings& settings) {
  std::array<Eigen::Vector3d, 3> points;
  constexpr std::array<const char*, 3> names = {"left_condyle", "right_condyle",
                                                "lower_incisal_point"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto point = patient.landmarks.find(names[i]);
    if (!point)
      throw InputError(
          fmt::format("{}: the opening motion needs the landmark {}; add it to the "
                      "case's landmarks",
                      patient.name, names[i]));
    points[i] = *point;
  }
  const Eigen::Vector3d across = points[0] - points[1];
  if (across.x() < 20)
    throw InputError(
        fmt::format("{}: left_condyle (x {:.1f}) must lie at least 20 mm to the left (+x) "
                    "of right_condyle (x {:.1f})",
                    patient.name, points[0].x(), points[1].x()));

  const double asked = settings.opening_mm;
  const double wanted =
      asked > 0 ? asked : (patient.condylar_path ? known_joint_opening_mm : imported_opening_mm);
  OpeningPath start;
  start.center = 0.5 * (points[0] + points[1]);
  start.axis = across.normalized();
  start.incisor = points[2];
  Choice choice = choose(std::move(start), patient, contacts,
                         couplings_to_try(settings.early_translation), wanted);
  const OpeningPath& path = choice.path;
  const double largest = path.opening_mm(choice.end);
  if (asked > 0 && largest < asked - 1e-6)
    throw InputError(
        fmt::format("opening {} mm: this jaw opens to {:.1f} mm when it turns by 45 "
                    "degrees; ask for less",
                    asked, largest));
  Motion motion;
  if (choice.free_end < choice.end) {
    const double free_mm = path.opening_mm(choice.free_end);
    motion.notes.push_back(fmt::format(
        "bone meets bone at an opening of {:.1f} mm of the {:.1f} mm wanted", free_mm, wanted));
    // What was asked for is tried, and contact stops it; the default keeps clear.
    if (asked == 0) choice.end = path.theta_for(std::max(free_mm - give_way_mm, 0.0));
  }
  const double forward = path.coupling.forward_mm(choice.end);
  motion.notes.push_back(fmt::format(
      "opening {:.1f} mm: rotation {:.1f} deg, condyles {:.1f} mm forward and {:.1f} mm down, "
      "early translation {:.2f}, {:.2f} deg/mm; {}",
      path.opening_mm(choice.end), choice.end / radian_per_degree, forward, path.drop_mm(forward),
      path.coupling.early, path.coupling.rad_per_mm / radian_per_degree, path.guide));
  motion.name = "opening";
  motion.duration_s = settings.duration_s;
  // Least jerk of the incisal point's drop, which is what one sees and measures.
  motion.wanted = [path, drop = path.opening_mm(choice.end),
                   duration = settings.duration_s](double time_s) {
    const double share = progress(time_s / duration);
    return share > 0 ? path.at(path.theta_for(drop * share)) : Pose{};
  };
  return motion;
}

}  // namespace condyle
