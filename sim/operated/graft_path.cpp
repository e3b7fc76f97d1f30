#include "sim/operated/graft_path.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>

#include "engine/core/error.h"
#include "engine/core/similar_word.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr std::string_view path_prefix = "path:";

const Seat& seat_named(const Scene& scene, const std::string& name) {
  if (!scene.plan || scene.plan->seats.empty())
    throw InputError(fmt::format("--motion path:{}: needs a --plan with a graft", name));
  std::vector<std::string> known;
  for (const Seat& seat : scene.plan->seats) {
    if (seat.name == name) return seat;
    known.push_back(seat.name);
  }
  throw InputError(fmt::format("--motion path:{}: the plan has no such graft{}; it has {}", name,
                               suggestion(name, known), fmt::join(known, ", ")));
}

/// The side that a surgeon works from.
Vector3d approach_of(const GraftLayout& graft, const ClinicalFrame& frame) {
  const auto& faces = graft.defect.faces;
  const Vector3d outward = frame.up.cross(faces[1].point - faces[0].point).normalized();
  constexpr double sideways = 0.7;
  return (graft.step.approach == "intraoral" ? frame.up : frame.down()) + sideways * outward;
}

/// Displacement of the graft at a fraction of the path: evenly along it. The jaw is at rest.
std::function<Pose(double s)> displacement_along(const InsertionPath& path) {
  if (!path.turns()) {
    const double far_mm =
        path.state == InsertionPath::State::blocked ? path.blocked_after_mm : path.length_mm;
    return [far_mm, direction = path.direction](double s) {
      Pose X;
      X.t = s * far_mm * direction;
      return X;
    };
  }
  // The poses lie evenly along the path: no point of the graft moves by more than a
  // millimetre between them.
  return [poses = path.poses](double s) {
    const double at = s * static_cast<double>(poses.size() - 1);
    const auto before = std::min(static_cast<std::size_t>(at), poses.size() - 2);
    return interpolate(poses[before], poses[before + 1], at - static_cast<double>(before));
  };
}

}  // namespace

std::vector<Seat> graft_seats(const Operated& operated, const Plan& plan) {
  ClinicalFrame frame;
  try {
    frame = clinical_frame(operated.patient.landmarks, plan.reference);
  } catch (const InputError&) {  // LPS
  }
  std::vector<Seat> seats;
  for (const GraftLayout& graft : operated.grafts) {
    Seat seat{.name = graft.step.name, .bodies = graft_bodies(graft.step), .face_normals = {}};
    const BodyTree& bodies = operated.patient.bodies;
    const Pose& X = operated.poses[bodies[*bodies.find(seat.bodies.front())].parent];
    for (const DefectFace& face : graft.defect.faces)
      seat.face_normals.push_back(X.R * face.normal);
    seat.approach = X.R * approach_of(graft, frame);
    seats.push_back(std::move(seat));
  }
  return seats;
}

bool is_insertion_path(const std::string& spec) { return spec.starts_with(path_prefix); }

Motion insertion_path_motion(const std::string& spec, const Scene& scene, double duration_s,
                             int threads) {
  const Seat& seat = seat_named(scene, spec.substr(path_prefix.size()));
  const InsertionPath path = find_insertion_path(scene.patient, seat, threads);
  constexpr double default_s = 6;
  Motion motion;
  motion.name = "insertion path of " + seat.name;
  motion.duration_s = duration_s > 0 ? duration_s : default_s;
  motion.target = [](double) { return Pose{}; };
  const double half_s = 0.5 * motion.duration_s;
  const BodyId first = *scene.patient.bodies.find(seat.bodies.front());
  motion.pieces = [=, along = displacement_along(path),
                   count = scene.patient.bodies.size()](double time_s) {
    const double s = 1 - std::min(std::abs(time_s - half_s) / half_s, 1.);
    std::vector<Pose> X_PB(static_cast<std::size_t>(count));
    X_PB[index_of(first)] = along(s);
    return X_PB;
  };
  motion.phases = {{"out of the seat", 0, half_s}, {"into the seat", half_s, motion.duration_s}};
  motion.notes.push_back(insertion_path_text(path, seat));
  return motion;
}

}  // namespace condyle
