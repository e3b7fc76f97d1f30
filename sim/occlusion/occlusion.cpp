#include "sim/occlusion/occlusion.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/error.h"
#include "sim/contact/contact.h"
#include "sim/occlusion/bite_contacts.h"

namespace condyle {
namespace {

constexpr double farthest_start_mm = 25, farthest_turn_deg = 30;
constexpr double residual_fraction = 0.01;  // of the closing force, tolerated at equilibrium
constexpr double min_side_fraction = 0.05;
constexpr double max_joint_fraction = 0.5;

IncisorOverlap incisors(const Arches& arches, const Pose& X_CM) {
  const Eigen::Vector3d lower = X_CM * arches.lower.edge - arches.upper.edge;
  return {-lower.dot(arches.front), lower.dot(arches.up)};
}

bool is_front(int fdi) { return fdi % 10 >= 1 && fdi % 10 <= 3; }

/// Exact distance of the arches, their overlap, and notes on bones that overlap deeper in the bite
/// than at rest.
void inspect_pairs(const Case& patient, const ContactSet& set, double max_overlap_mm, Bite& bite) {
  for (const auto& pair : set.pairs) {
    const Part &a = patient.parts[pair.part_a], &b = patient.parts[pair.part_b];
    if (a.name == bite.upper && b.name == bite.lower) {
      bite.gap_mm = pair.distance_mm;
      bite.overlap_mm = pair.depth_mm;
    } else if (pair.touching && pair.depth_mm > std::max(max_overlap_mm, pair.rest_depth_mm)) {
      bite.notes.push_back(fmt::format(
          "{} and {} overlap by {:.2f} mm in this bite; at rest {}", a.name, b.name, pair.depth_mm,
          pair.rest_depth_mm > 0 ? fmt::format("by {:.2f} mm", pair.rest_depth_mm)
                                 : "they are apart"));
    }
  }
}

/// By which bites of different starts are ranked, N mm: the work, and what uneven load counts.
double grid_charge(const Bite& bite, const OcclusionSettings& settings) {
  constexpr double uneven_mm = 1, unstable_mm = 5;  // of closing that it is worth
  const double uneven = 2 * std::abs(bite.left_fraction - 0.5);
  return bite.rest.work +
         settings.closing_force_N * (uneven_mm * uneven + (bite.stable ? 0 : unstable_mm));
}

std::string why_unstable(const Bite& bite, const OcclusionSettings& settings) {
  if (!bite.rest.converged) return "the arches did not reach equilibrium";
  if (bite.contacts.empty()) return "no teeth are in contact";
  if (bite.overlap_mm > settings.max_overlap_mm)
    return fmt::format("the arches still overlap by {:.2f} mm", bite.overlap_mm);
  if (std::min(bite.left_fraction, 1 - bite.left_fraction) < min_side_fraction)
    return fmt::format("only the {} side carries load",
                       bite.left_fraction > 0.5 ? "left" : "right");
  if (bite.joint_fraction > max_joint_fraction)
    return fmt::format(
        "the joints rather than the teeth support the mandible: they carry {:.0f} % of the "
        "closing force",
        100 * bite.joint_fraction);
  return "";
}

}  // namespace

Pose displaced_from_rest(const Case& patient, const Eigen::Vector3d& moved_mm,
                         const Eigen::Vector3d& turned_deg) {
  const Eigen::Vector3d pivot = find_arches(patient).lower.middle();
  const double angle = turned_deg.norm() * std::numbers::pi / 180;
  Pose pose;
  if (angle > 0) pose.R = Eigen::AngleAxisd(angle, turned_deg.normalized());
  pose.t = pivot + moved_mm - pose.R * pivot;
  return pose;
}

struct BiteFinder::State {
  State(const Case& the_patient, const OcclusionSettings& the_settings, const Progress& progress)
      : patient(the_patient),
        settings(the_settings),
        arches(find_arches(patient)),
        model(arches, settings, progress),
        contacts(patient) {}

  const Case& patient;
  OcclusionSettings settings;
  Arches arches;
  BiteModel model;
  ContactModel contacts;
};

BiteFinder::BiteFinder(const Case& patient, const OcclusionSettings& settings,
                       const Progress& progress)
    : state_(std::make_unique<State>(patient, settings, progress)) {}
BiteFinder::~BiteFinder() = default;
BiteFinder::BiteFinder(BiteFinder&&) noexcept = default;

void BiteFinder::check_start(const Pose& start) const {
  if (!start.R.coeffs().allFinite() || !start.t.allFinite())
    throw InputError("the start is not a finite pose; give numbers");
  const Arch& lower = state_->arches.lower;
  for (const auto& p : {lower.edge, lower.molars[0], lower.molars[1]})
    if (const double shift_mm = (start * p - p).norm(); !(shift_mm <= farthest_start_mm))
      throw InputError(fmt::format(
          "at the start the lower teeth are {:.3g} mm from their position in the case; at most "
          "{:.0f} mm are allowed",
          shift_mm, farthest_start_mm));
  const double turn_deg = rotation_angle(start) * 180 / std::numbers::pi;
  if (turn_deg > farthest_turn_deg)
    throw InputError(
        fmt::format("at the start the lower teeth are rotated by {:.3g} degrees; at most {:.0f} "
                    "degrees are allowed",
                    turn_deg, farthest_turn_deg));
}

Bite BiteFinder::measured(const RestingPose& rest, const Pose& start) const {
  const auto& [patient, settings, arches, model, all_contacts] = *state_;
  Bite bite;
  bite.notes = arches.notes;
  bite.upper = arches.upper.part->name;
  bite.lower = arches.lower.part->name;
  bite.up = arches.up;
  bite.midline_mm = arches.midline_mm;
  bite.upper_edge = arches.upper.edge;
  bite.rest = rest;
  bite.rest.converged = bite.rest.residual_N < residual_fraction * settings.closing_force_N;
  const Pose& X_CM = bite.rest.X_CM;
  bite.contacts = find_contacts(arches, model, X_CM);
  bite.teeth = tooth_loads(arches, bite.contacts);
  bite.front_known = !arches.upper.part->teeth.empty() && !arches.lower.part->teeth.empty();
  for (const auto& contact : bite.contacts) {
    if (contact.left) bite.left_fraction += contact.load_fraction;
    if (is_front(contact.lower_fdi)) bite.front_fraction += contact.load_fraction;
    bite.load_center += contact.load_fraction * contact.place;
  }
  bite.joint_fraction = model.joint_force_N(X_CM) / settings.closing_force_N;
  inspect_pairs(patient,
                all_contacts.find(with_jaw_at(patient.bodies, X_CM), nullptr, settings.threads),
                settings.max_overlap_mm, bite);
  bite.before = incisors(arches, {});
  bite.after = incisors(arches, X_CM);
  bite.moved_from_start_mm = model.max_displacement_mm(start, X_CM);
  bite.moved_from_rest_mm = model.max_displacement_mm({}, X_CM);
  bite.rotation_deg = rotation_angle(X_CM) * 180 / std::numbers::pi;
  if (arches.condyles) {
    bite.condyle_moved.emplace();
    for (int side = 0; side < 2; ++side) {
      const auto& condyle = (*arches.condyles)[side];
      (*bite.condyle_moved)[side] = X_CM * condyle - condyle;
    }
  }
  bite.unstable_because = why_unstable(bite, settings);
  bite.stable = bite.unstable_because.empty();
  return bite;
}

Bite BiteFinder::find(const Pose& start, const Progress& progress) const {
  check_start(start);
  int starts = 0;
  const auto found = find_bites(state_->model, start, state_->settings, starts, progress);
  report(progress, "contacts", 0.9);
  Bite bite = measured(found.front(), start);
  bite.others.assign(found.begin() + 1, found.end());
  bite.starts = starts;
  return bite;
}

std::vector<Bite> BiteFinder::find_from_grid(const Pose& start, const Progress& progress) const {
  constexpr std::size_t shown = 3;
  check_start(start);
  const OcclusionSettings& settings = state_->settings;
  int starts = 0;
  const auto found = find_bites_from_grid(state_->model, start, settings, starts, progress);
  std::vector<Bite> bites;
  for (const RestingPose& rest : found) {
    bites.push_back(measured(rest, start));
    bites.back().starts = starts;
    report(progress, "contacts", 0.9);
  }
  const auto charge = [&](const Bite& bite) { return grid_charge(bite, settings); };
  std::stable_sort(bites.begin(), bites.end(),
                   [&](const Bite& a, const Bite& b) { return charge(a) < charge(b); });
  if (bites.size() > shown) bites.resize(shown);
  return bites;
}

}  // namespace condyle
