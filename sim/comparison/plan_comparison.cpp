#include "sim/comparison/plan_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/repair.h"
#include "engine/registration/rigid_fit.h"
#include "engine/registration/surface_fit.h"
#include "sim/plan/move.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

bool is_bone(const Part& part) { return collides(part.role) && !is_teeth(part.role); }

/// Vertices of a body's bones and teeth on their own surface, not on cut faces, with normals.
struct BodySurface {
  std::vector<Vector3d> points, normals;
};

void add_surface(BodySurface& surface, const Part& part, const SurfaceOrigin* origin) {
  std::vector<bool> used(part.mesh.vertices.size(), false), cut(used);
  for (std::size_t t = 0; t < part.mesh.triangles.size(); ++t)
    for (const int corner : part.mesh.triangles[t])
      (origin && origin->triangle[t] < 0 ? cut : used)[static_cast<std::size_t>(corner)] = true;
  const auto normals = vertex_normals(part.mesh);
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i] && !cut[i] && !normals[i].isZero()) {
      surface.points.push_back(part.mesh.vertices[i]);
      surface.normals.push_back(normals[i]);
    }
}

BodySurface surface_of(const Operated& operated, BodyId body) {
  BodySurface surface;
  for (const Part& part : operated.patient.parts) {
    if (part.body != body || !is_bone(part)) continue;
    const auto origin = operated.origin.find(part.name);
    add_surface(surface, part, origin == operated.origin.end() ? nullptr : &origin->second);
  }
  return surface;
}

/// At most about `most` of the points, evenly by number, under a pose.
BodySurface thinned(const BodySurface& surface, std::size_t most, const Pose& X) {
  BodySurface thin;
  const std::size_t step = std::max<std::size_t>(1, surface.points.size() / most);
  for (std::size_t i = 0; i < surface.points.size(); i += step) {
    thin.points.push_back(X * surface.points[i]);
    thin.normals.push_back(X.R * surface.normals[i]);
  }
  return thin;
}

Vector3d centroid_of_points(const BodySurface& surface) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& p : surface.points) sum += p;
  return surface.points.empty() ? sum : Vector3d(sum / static_cast<double>(surface.points.size()));
}

/// `X` takes a segment from its place in the first to that in the second.
SegmentDifference segment_difference(const std::string& body, const Pose& X,
                                     const Vector3d& centroid, const ClinicalFrame& frame) {
  const ClinicalMove move = clinical_move(X, frame, centroid);
  SegmentDifference difference;
  difference.body = body;
  difference.left_mm = move.left_mm;
  difference.forward_mm = move.forward_mm;
  difference.up_mm = move.up_mm;
  difference.yaw_deg = move.yaw_deg;
  difference.pitch_deg = move.pitch_deg;
  difference.roll_deg = move.roll_deg;
  difference.angle_deg = rotation_angle(X) * 180 / std::numbers::pi;
  return difference;
}

double bone_volume(const Operated& operated, BodyId body) {
  double volume = 0;
  for (const Part& part : operated.patient.parts)
    if (part.body == body && is_bone(part)) volume += signed_volume(part.mesh);
  return volume;
}

void note_segments(const Operated& first, const Operated& second, PlanComparison& comparison) {
  constexpr double differs = 1e-3;
  const auto note_absent = [&](const Operated& a, const Operated& b, const std::string& name) {
    for (const Body& body : a.patient.bodies.bodies())
      if (!b.patient.bodies.find(body.name))
        comparison.notes.push_back(fmt::format("{} is a segment of {} alone", body.name, name));
  };
  note_absent(first, second, comparison.first);
  note_absent(second, first, comparison.second);
  for (int b = 1; b < first.patient.bodies.size(); ++b) {
    const std::string& name = first.patient.bodies[BodyId{b}].name;
    const auto other = second.patient.bodies.find(name);
    if (!other) continue;
    const double here = bone_volume(first, BodyId{b}), there = bone_volume(second, *other);
    if (std::abs(here - there) > differs * std::max(here, there))
      comparison.notes.push_back(
          fmt::format("{} is cut differently: {:.2f} cm\u00b3 and {:.2f} "
                      "cm\u00b3",
                      name, here / 1000, there / 1000));
  }
}

/// All bones of a case as one surface, or those of one part.
TriMesh bones_of(const Case& patient, const std::string& only = "") {
  TriMesh mesh;
  for (const Part& part : patient.parts) {
    if (!is_bone(part) || (!only.empty() && part.name != only)) continue;
    const auto first = static_cast<int>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), part.mesh.vertices.begin(), part.mesh.vertices.end());
    for (const Eigen::Vector3i& t : part.mesh.triangles)
      mesh.triangles.emplace_back(t.array() + first);
  }
  return mesh;
}

/// Landmarks of the cranium that no operation of the jaws moves.
constexpr std::array cranial_landmarks{"nasion",         "basion",       "sella",
                                       "left_porion",    "right_porion", "left_orbitale",
                                       "right_orbitale", "glabella"};

/// X_AP of the achieved case from the planned patient, by landmarks of the cranium; identity
/// without.
Pose cranial_start(const Landmarks& planned, const Landmarks& achieved) {
  std::vector<Vector3d> p_P, p_A;
  for (const char* name : cranial_landmarks) {
    const auto p = planned.find(name), a = achieved.find(name);
    if (!p || !a) continue;
    p_P.push_back(*p);
    p_A.push_back(*a);
  }
  return rigid_fit(p_P, p_A).value_or(Pose{});
}

SurfaceFit fit_on(const BodySurface& surface, const SurfacePairs& bone, const Pose& start,
                  int threads) {
  return fit_to_surface(surface.points, surface.normals, bone, start,
                        {.kept = 0.8, .threads = threads});
}

Pose registered_cranium(const Operated& planned, const Case& achieved, const SurfacePairs& bones,
                        int threads, PlanComparison& comparison) {
  constexpr double poor_mm = 2;
  const BodySurface cranium = thinned(surface_of(planned, cranium_body), 6000, {});
  if (cranium.points.empty())
    throw InputError("the planned patient has no bone of the cranium to register the case on");
  const SurfaceFit fit =
      fit_on(cranium, bones, cranial_start(planned.patient.landmarks, achieved.landmarks), threads);
  if (!fit.converged || fit.rms_mm > poor_mm)
    throw InputError(fmt::format(
        "the case \"{}\" could not be registered on the cranium: {} of {} points have a partner, "
        "{:.1f} mm RMS; give it the landmarks nasion, porions and orbitales",
        achieved.name, fit.pairs, cranium.points.size(), fit.rms_mm));
  comparison.notes.push_back(
      fmt::format("{} is registered on {} points of the cranium, {:.2f} mm RMS", achieved.name,
                  fit.pairs, fit.rms_mm));
  return fit.X_BA;
}

}  // namespace

PlanComparison compare_plans(const Operated& first, const Operated& second,
                             const ClinicalFrame& frame) {
  PlanComparison comparison;
  const BodyTree& tree = first.patient.bodies;
  for (int b = 1; b < tree.size(); ++b) {
    const BodyId body{b};
    const auto other = second.patient.bodies.find(tree[body].name);
    if (!other) continue;
    const Pose &X_C1 = first.poses[body], &X_C2 = second.poses[*other];
    const Vector3d centroid = X_C1 * centroid_of_points(surface_of(first, body));
    comparison.segments.push_back(
        segment_difference(tree[body].name, X_C2 * X_C1.inverse(), centroid, frame));
  }
  if (comparison.segments.empty()) throw InputError("the plans have no segment of the same name");
  const MovementTable here = planned_movements(first, frame),
                      there = planned_movements(second, frame);
  for (const MovementRow& row : here.rows)
    for (const MovementRow& other : there.rows)
      if (row.landmark == other.landmark)
        comparison.landmarks.push_back({row.label, row.landmark, other.left_mm - row.left_mm,
                                        row.back_mm - other.back_mm, other.up_mm - row.up_mm});
  comparison.first = "the first plan";
  comparison.second = "the second plan";
  note_segments(first, second, comparison);
  return comparison;
}

PlanComparison compare_with_case(const Operated& planned, const Case& achieved,
                                 const ClinicalFrame& frame, int threads) {
  PlanComparison comparison;
  comparison.first = "the plan";
  comparison.second = achieved.name;
  const TriMesh all = bones_of(achieved);
  if (all.empty()) throw InputError(fmt::format("the case \"{}\" has no bone", achieved.name));
  const SurfacePairs bones(all);
  const Pose X_AP = registered_cranium(planned, achieved, bones, threads, comparison);
  const BodyTree& tree = planned.patient.bodies;
  for (int b = 1; b < tree.size(); ++b) {
    const BodyId body{b};
    const std::string& name = tree[body].name;
    const BodySurface surface = thinned(surface_of(planned, body), 4000, planned.poses[body]);
    if (surface.points.empty()) continue;
    const TriMesh own = bones_of(achieved, name);
    const SurfaceFit fit = own.empty() ? fit_on(surface, bones, X_AP, threads)
                                       : fit_on(surface, SurfacePairs(own), X_AP, threads);
    if (!fit.converged) {
      comparison.notes.push_back(
          fmt::format("{} could not be registered on the case's bone", name));
      continue;
    }
    comparison.segments.push_back(
        segment_difference(name, X_AP.inverse() * fit.X_BA, centroid_of_points(surface), frame));
    comparison.segments.back().rms_mm = fit.rms_mm;
  }
  const Landmarks now = planned_landmarks(planned);
  for (const MovementRow& row : planned_movements(planned, frame).rows)
    if (const auto point = achieved.landmarks.find(row.landmark)) {
      const Vector3d off = frame.components(X_AP.inverse() * *point - *now.find(row.landmark));
      comparison.landmarks.push_back({row.label, row.landmark, off.x(), -off.y(), off.z()});
    }
  return comparison;
}

}  // namespace condyle
