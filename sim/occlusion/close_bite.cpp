#include "sim/occlusion/close_bite.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/core/error.h"
#include "engine/core/parallel.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double field_spacing_mm = 0.25, field_band_mm = 1;
constexpr double fine_spacing_mm = 0.3, coarse_spacing_mm = 0.8;
constexpr double coarse_layer_mm = 0.4;    // bridges the spacing of the coarse points
constexpr double rotation_length_mm = 25;  // half an arch
constexpr double longest_step_mm =
    0.3;  // well below the band of the field, so that no surface is passed
constexpr double still_mm = 1e-6;
constexpr int max_steps = 400;
constexpr double open_step_mm = 0.5, max_open_mm = 30;
constexpr double same_mm = 0.1;
constexpr double slipped_mm = 15;  // displacement from the start of an arch without a bite
constexpr int max_rounds = 4;
constexpr std::size_t refined = 3;  // coarse bites that are refined

/// Adds bites to a list that is sorted by energy, without those that are in it.
void add_distinct(const BiteModel& model, const std::vector<RestingPose>& more,
                  std::vector<RestingPose>& found) {
  found.insert(found.end(), more.begin(), more.end());
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.work < b.work; });
  std::vector<RestingPose> distinct;
  for (const auto& bite : found)
    if (std::none_of(distinct.begin(), distinct.end(), [&](const auto& kept) {
          return model.max_displacement_mm(kept.X_CM, bite.X_CM) < same_mm;
        }))
      distinct.push_back(bite);
  found = std::move(distinct);
}

/// Drops poses in which the lower arch has slipped off the upper one, which has the least energy of
/// all; of these alone, the one nearest to the start stays.
void drop_slipped(const BiteModel& model, const Pose& start, std::vector<RestingPose>& poses) {
  const auto moved = [&](const RestingPose& pose) {
    return model.max_displacement_mm(pose.X_CM, start);
  };
  const RestingPose nearest =
      *std::min_element(poses.begin(), poses.end(),
                        [&](const auto& a, const auto& b) { return moved(a) < moved(b); });
  std::erase_if(poses, [&](const auto& pose) { return !(moved(pose) < slipped_mm); });
  if (poses.empty()) poses.push_back(nearest);
}

[[noreturn]] void refuse_overlap() {
  throw InputError(fmt::format(
      "the arches overlap so deeply at the start that {:.0f} mm of opening do not separate them",
      max_open_mm));
}

DistanceField field_of(const Arch& arch, const OcclusionSettings& settings) {
  return cached_field(
      settings.cache, arch.part->mesh,
      {.spacing_mm = field_spacing_mm, .band_mm = field_band_mm, .region = arch.crowns},
      settings.threads);
}

}  // namespace

BiteModel::BiteModel(const Arches& arches, const OcclusionSettings& settings,
                     const Progress& progress)
    : arches_(arches),
      settings_(settings),
      upper_field_((report(progress, "upper arch", 0), field_of(arches.upper, settings))),
      lower_field_((report(progress, "lower arch", 0.3), field_of(arches.lower, settings))),
      fine_upper_(
          make_layer_surface(arches.upper.part->mesh, arches.upper.crowns, fine_spacing_mm)),
      fine_lower_(
          make_layer_surface(arches.lower.part->mesh, arches.lower.crowns, fine_spacing_mm)),
      coarse_upper_(
          make_layer_surface(arches.upper.part->mesh, arches.upper.crowns, coarse_spacing_mm)),
      coarse_lower_(
          make_layer_surface(arches.lower.part->mesh, arches.lower.crowns, coarse_spacing_mm)),
      fine_({&fine_upper_, &upper_field_}, {&fine_lower_, &lower_field_},
            {settings.film_mm, settings.layer_stiffness_MPa}),
      coarse_({&coarse_upper_, &upper_field_}, {&coarse_lower_, &lower_field_},
              {std::max(coarse_layer_mm, settings.film_mm), settings.layer_stiffness_MPa}) {
  pivot_ = arches.lower.middle();
  Box crowns;
  for (const auto& piece : coarse_lower_.pieces) crowns.add(piece.point);
  for (int i = 0; i < 8; ++i)
    crown_corners_.emplace_back((i & 1 ? crowns.high : crowns.low).x(),
                                (i & 2 ? crowns.high : crowns.low).y(),
                                (i & 4 ? crowns.high : crowns.low).z());
}

double BiteModel::max_displacement_mm(const Pose& a, const Pose& b) const {
  // Displacement is a convex function of the point, so a corner of the box has the largest.
  double largest = 0;
  for (const auto& p : crown_corners_) largest = std::max(largest, (a * p - b * p).norm());
  return largest;
}

Pose BiteModel::moved(const Pose& X_CM, const Twist& x) const {
  const Vector3d turn = x.tail<3>() / rotation_length_mm;
  const double angle = turn.norm();
  Pose out = X_CM;
  if (angle > 0)
    out.R = (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * X_CM.R).normalized();
  out.t = X_CM * pivot_ + x.head<3>() - out.R * pivot_;
  return out;
}

Pose BiteModel::beside(const Pose& X_CM, const Vector3d& left_front_up, double yaw_rad) const {
  Twist x;
  x << left_front_up.x() * arches_.left + left_front_up.y() * arches_.front +
           left_front_up.z() * arches_.up,
      yaw_rad * rotation_length_mm * arches_.up;
  return moved(X_CM, x);
}

std::optional<Pose> BiteModel::opened(const Pose& X_CM) const {
  for (double mm = 0; mm <= max_open_mm; mm += open_step_mm) {
    const Pose open = beside(X_CM, {0, 0, -mm}, 0);
    if (coarse_.free(open)) return open;
  }
  return std::nullopt;
}

LayerForce BiteModel::total(const LayerContact& layer, const Pose& X_CM, int threads) const {
  LayerForce sum = layer.evaluate(X_CM, pivot_, rotation_length_mm, threads);
  const Vector3d center = X_CM * pivot_;
  for (const auto& molar : arches_.lower.molars) {
    const Vector3d at = X_CM * molar, force = 0.5 * settings_.closing_force_N * arches_.up;
    sum.energy -= force.dot(at - molar);
    sum.gradient -= contact_row(at - center, force, 0, rotation_length_mm).along;
  }
  if (!arches_.condyles) return sum;
  for (const auto& condyle : *arches_.condyles) {
    const Vector3d at = X_CM * condyle;
    for (int axis = 0; axis < 3; ++axis) {
      const double k = settings_.joint_N_per_mm, off = at[axis] - condyle[axis];
      const Twist row = contact_row(at - center, Vector3d::Unit(axis), 0, rotation_length_mm).along;
      sum.energy += 0.5 * k * off * off;
      sum.gradient += k * off * row;
      sum.hessian += k * row * row.transpose();
    }
  }
  return sum;
}

double BiteModel::joint_force_N(const Pose& X_CM) const {
  double force = 0;
  if (arches_.condyles)
    for (const auto& condyle : *arches_.condyles)
      force += settings_.joint_N_per_mm * (X_CM * condyle - condyle).norm();
  return force;
}

/// Levenberg-Marquardt descent.
RestingPose BiteModel::close_from(const LayerContact& layer, const Pose& from, int threads) const {
  const double min_damping = 1e-4 * settings_.closing_force_N;
  double damping = 1e-3 * settings_.closing_force_N;
  RestingPose rest{from, 0, false, 0};
  LayerForce now = total(layer, from, threads);
  for (int k = 0; k < max_steps && !rest.converged; ++k) {
    Eigen::Matrix<double, 6, 6> A = now.hessian;
    A.diagonal().array() += damping;
    Twist x = -A.ldlt().solve(now.gradient);
    const double step = x.norm();
    if (step > longest_step_mm) x *= longest_step_mm / step;
    const Pose X = moved(rest.X_CM, x);
    const LayerForce there = total(layer, X, threads);
    if (there.energy < now.energy) {
      rest.X_CM = X;
      now = there;
      damping = std::max(0.3 * damping, min_damping);
    } else {
      damping *= 4;
    }
    rest.converged = step < still_mm;
  }
  rest.work = now.energy;
  rest.residual_N = now.gradient.norm();
  return rest;
}

std::vector<RestingPose> find_bites(const BiteModel& model, const Pose& start,
                                    const OcclusionSettings& settings, int& starts,
                                    const Progress& progress) {
  std::vector<RestingPose> found;
  const auto add = [&](const std::vector<RestingPose>& more) { add_distinct(model, more, found); };
  report(progress, "closing", 0.5);
  const auto open = model.opened(start);
  if (!open) refuse_overlap();
  add({model.coarse(*open, settings.threads)});
  starts = 1;
  // Restarts near the best bite until it remains the best.
  const double s = settings.search_mm, turn = settings.search_deg * std::numbers::pi / 180;
  for (int round = 0; round < max_rounds; ++round) {
    const Pose best = found.front().X_CM;
    if (!found.front().converged) break;  // unstable: it slides away
    std::vector<Pose> froms;
    const auto add_from = [&](const Vector3d& left_front_up, double yaw_rad) {
      if (const auto from = model.opened(model.beside(best, left_front_up, yaw_rad)))
        froms.push_back(*from);
    };
    for (const double left : {-s, 0.0, s})
      for (const double front : {-s, 0.0, s})
        if (left != 0 || front != 0) add_from({left, front, 0}, 0);
    for (const double yaw : {-turn, turn}) add_from(Vector3d::Zero(), yaw);
    std::vector<RestingPose> more(froms.size());
    parallel_for(froms.size(), settings.threads,
                 [&](std::size_t i) { more[i] = model.coarse(froms[i], 1); });
    starts += static_cast<int>(froms.size());
    add(more);
    report(progress, "searching nearby", 0.6 + 0.08 * round);
    if (model.max_displacement_mm(best, found.front().X_CM) < same_mm) break;
  }
  std::vector<RestingPose> coarse = std::move(found);
  if (coarse.size() > refined) coarse.resize(refined);
  found.clear();
  for (const auto& bite : coarse)
    add({model.fine(model.opened(bite.X_CM).value_or(bite.X_CM), settings.threads)});
  return found;
}

std::vector<RestingPose> find_bites_from_grid(const BiteModel& model, const Pose& start,
                                              const OcclusionSettings& settings, int& starts,
                                              const Progress& progress) {
  constexpr double sideways_mm = 2, forward_mm = 3, turn_rad = 2 * std::numbers::pi / 180;
  constexpr std::size_t kept = 6;
  std::vector<Pose> froms;
  for (const double left : {0.0, -sideways_mm, sideways_mm})
    for (const double front : {0.0, -forward_mm, forward_mm})
      for (const double yaw : {0.0, -turn_rad, turn_rad})
        if (const auto from = model.opened(model.beside(start, {left, front, 0}, yaw)))
          froms.push_back(*from);
  if (froms.empty()) refuse_overlap();
  report(progress, "closing from a grid", 0.5);
  std::vector<RestingPose> coarse(froms.size()), found, refined_bites;
  parallel_for(froms.size(), settings.threads,
               [&](std::size_t i) { coarse[i] = model.coarse(froms[i], 1); });
  starts = static_cast<int>(froms.size());
  drop_slipped(model, start, coarse);
  add_distinct(model, coarse, found);
  if (found.size() > kept) found.resize(kept);
  report(progress, "refining", 0.8);
  std::vector<RestingPose> fine;
  for (const auto& bite : found)
    fine.push_back(model.fine(model.opened(bite.X_CM).value_or(bite.X_CM), settings.threads));
  drop_slipped(model, start, fine);
  add_distinct(model, fine, refined_bites);
  return refined_bites;
}

}  // namespace condyle
