#include "sim/contact/turned_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "engine/collide/path_search.h"
#include "engine/core/user_cache.h"
#include "engine/mesh/measure.h"
#include "sim/contact/contact.h"
#include "sim/contact/sliding_settings.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

// Of the samples that the search moves by, which contact verifies: a fifth of the time.
constexpr double searched_sample_mm = 1.5, searched_edge_mm = 0.5, searched_rise_mm = 0.1;
constexpr int searches = 2, poses_of_search = 20'000;
constexpr double followed_step_mm = 1, followed_mm = 0.1;

/// The graft and what it may meet, prepared for contact.
struct Surfaces {
  std::vector<std::shared_ptr<const ContactSurface>> fixed, moving, coarse_fixed, coarse_moving;
  Box graft;
};

ContactSurface coarse(const DistanceField& field, const TriMesh& mesh) {
  return {field, sample_surface(mesh, {.spacing_mm = searched_sample_mm,
                                       .edge_rise_mm = searched_rise_mm,
                                       .edge_spacing_mm = searched_edge_mm,
                                       .region = field.settings().region})};
}

SlidingContact contact_of(const std::vector<std::shared_ptr<const ContactSurface>>& fixed,
                          const std::vector<std::shared_ptr<const ContactSurface>>& moving,
                          const std::optional<Eigen::Vector3d>& pivot, double rotation_length_mm) {
  SlideSettings settings;
  settings.slop_mm = SlidingResolution::slop_mm;
  settings.rotation_length_mm = rotation_length_mm;
  settings.pivot = pivot;
  SlidingContact contact(fixed, moving, settings);
  contact.allow_overlap_at({}, SlidingResolution::fade_mm);
  return contact;
}

Surfaces surfaces_near(const Case& patient, const std::vector<BodyId>& graft, double length_mm,
                       int threads) {
  const auto moves = [&](const Part& part) {
    return std::find(graft.begin(), graft.end(), part.body) != graft.end();
  };
  Surfaces near;
  for (const Part& part : patient.parts)
    if (collides(part.role) && moves(part)) near.graft.add(bounding_box(part.mesh));
  const Box region{near.graft.low.array() - length_mm, near.graft.high.array() + length_mm};
  for (const Part& part : patient.parts) {
    if (!collides(part.role) || part.mesh.empty()) continue;
    const Box box = bounding_box(part.mesh);
    if ((box.low.array() > region.high.array()).any() ||
        (region.low.array() > box.high.array()).any())
      continue;
    ContactSurfaceSettings settings;
    settings.field.spacing_mm = moves(part)           ? SlidingResolution::roaming_spacing_mm
                                : is_teeth(part.role) ? SlidingResolution::tooth_spacing_mm
                                                      : SlidingResolution::jaw_spacing_mm;
    if (!moves(part)) settings.field.region = region;
    settings.samples.spacing_mm = is_teeth(part.role) ? SlidingResolution::tooth_sample_mm
                                                      : SlidingResolution::bone_sample_mm;
    settings.cache = user_cache_folder();
    (moves(part) ? near.moving : near.fixed)
        .push_back(std::make_shared<const ContactSurface>(
            make_contact_surface(part.mesh, settings, threads)));
    (moves(part) ? near.coarse_moving : near.coarse_fixed)
        .push_back(std::make_shared<const ContactSurface>(
            coarse((moves(part) ? near.moving : near.fixed).back()->field, part.mesh)));
  }
  return near;
}

std::vector<Pose> goals_of(const Seat& seat, const std::vector<Vector3d>& directions,
                           double length_mm) {
  std::vector<Pose> goals;
  const auto add = [&](const Vector3d& d) {
    goals.push_back({Eigen::Quaterniond::Identity(), length_mm * d});
  };
  const Vector3d approach = seat.approach.normalized(), u = approach.unitOrthogonal(),
                 v = approach.cross(u);
  add(approach);
  for (const Vector3d& d : directions) add(d);
  for (const double degrees : {25., 50., 75.})
    for (int i = 0; i < 8; ++i) {
      const double turn = i * std::numbers::pi / 4, tilt = degrees * std::numbers::pi / 180;
      add(std::cos(tilt) * approach + std::sin(tilt) * (std::cos(turn) * u + std::sin(turn) * v));
    }
  return goals;
}

/// Largest displacement of a corner of a box between two poses.
double displacement(const Box& box, const Pose& X, const Pose& to) {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d p((corner & 1 ? box.low : box.high).x(), (corner & 2 ? box.low : box.high).y(),
                     (corner & 4 ? box.low : box.high).z());
    most = std::max(most, (X * p - to * p).norm());
  }
  return most;
}

/// The path as contact lets the graft follow it; empty where it cannot.
std::vector<Pose> followed(const ContactModel& contacts, BodyId first, int bodies,
                           const std::vector<Pose>& path, const Box& graft, const Vector3d& pivot,
                           int threads) {
  BodyPoses at = contacts.placed({});
  ContactSet set = contacts.at_rest();
  std::vector<Pose> poses = {path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const int steps = std::max(
        1,
        static_cast<int>(std::ceil(displacement(graft, path[i - 1], path[i]) / followed_step_mm)));
    for (int k = 1; k <= steps; ++k) {
      const Pose target = interpolate(path[i - 1], path[i], static_cast<double>(k) / steps, pivot);
      std::vector<Pose> X_PB(static_cast<std::size_t>(bodies));
      X_PB[index_of(first)] = target;
      ContactModel::Slide slid = contacts.slide(at, X_PB, &set, threads, true);
      at = std::move(slid.at);
      set = std::move(slid.contacts);
      if (displacement(graft, at[first], target) > followed_mm) return {};
      poses.push_back(at[first]);
    }
  }
  return poses;
}

}  // namespace

TurnedPath find_turned_path(const Case& patient, const Seat& seat, const std::vector<BodyId>& graft,
                            const std::vector<Vector3d>& directions, double length_mm,
                            int threads) {
  TurnedPath result;
  const Surfaces near = surfaces_near(patient, graft, length_mm, threads);
  const SlidingContact contact = contact_of(near.fixed, near.moving, std::nullopt, 0),
                       rough = contact_of(near.coarse_fixed, near.coarse_moving, contact.pivot(),
                                          contact.rotation_length_mm());
  std::unique_ptr<const ContactModel> contacts;
  for (int search = 0; search < searches; ++search) {
    const PathSearch found = find_path(rough, contact, {}, goals_of(seat, directions, length_mm),
                                       {.directions = directions,
                                        .reach_mm = 1.2 * length_mm,
                                        .max_poses = poses_of_search,
                                        .seed = static_cast<std::uint64_t>(search + 1)});
    result.examined += found.examined;
    result.farthest_mm = std::max(result.farthest_mm, found.farthest_mm);
    if (found.poses.empty()) continue;
    if (!contacts) {
      ContactSettings settings;
      settings.advise_exits = false;
      contacts = std::make_unique<const ContactModel>(patient, settings);
    }
    result.poses = followed(*contacts, graft.front(), patient.bodies.size(), found.poses,
                            near.graft, contact.pivot(), threads);
    if (!result.poses.empty()) break;
  }
  return result;
}

}  // namespace condyle
