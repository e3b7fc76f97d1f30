#include "sim/session/drawn_cut.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/error.h"
#include "engine/cut/cut.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/operation/closed_bone.h"
#include "sim/osteotomy/osteotomy.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double gap_mm = 5;       // between walls of bone
constexpr double beyond_mm = 1.5;  // a cut ends so far behind the bone that it divides

const Part& drawn_part(const Operated& operated, const std::string& name) {
  for (const Part& part : operated.patient.parts)
    if (part.name == name) return part;
  throw InputError(fmt::format("the patient has no bone \"{}\"", name));
}

/// Points of the polyline, at most a millimetre apart.
std::vector<Vector3d> samples_of(const std::vector<Vector3d>& polyline) {
  std::vector<Vector3d> samples = {polyline.front()};
  for (std::size_t i = 0; i + 1 < polyline.size(); ++i) {
    const Vector3d step = polyline[i + 1] - polyline[i];
    const int count = std::max(1, static_cast<int>(std::ceil(step.norm())));
    for (int k = 1; k <= count; ++k) samples.push_back(polyline[i] + step * k / count);
  }
  return samples;
}

/// From the deepest point of the polyline to the far side of the first wall of bone behind it.
double depth_of_wall(const TriMesh& bone, const BentSheet& sheet) {
  const TriangleTree tree(bone);
  const Vector3d into = sheet.direction.normalized();
  double start = -std::numeric_limits<double>::infinity(), end = start;
  for (const Vector3d& p : sheet.polyline) start = std::max(start, into.dot(p));
  struct Wall {
    double in = 0, out = 0;  // along the direction
  };
  std::vector<Wall> walls;
  for (const Vector3d& sample : samples_of(sheet.polyline)) {
    const Vector3d from = sample - sheet.overhang_mm * into;
    const auto in = tree.ray_cast(from, into);
    if (!in) continue;
    const double past = in->distance + 1e-3;
    if (const auto out = tree.ray_cast(from + past * into, into))
      walls.push_back({into.dot(from) + in->distance, into.dot(from) + past + out->distance});
  }
  // What begins far behind all that is nearer is another wall, such as the other side of the jaw.
  std::sort(walls.begin(), walls.end(), [](const Wall& a, const Wall& b) { return a.in < b.in; });
  for (const Wall& wall : walls) {
    if (end > -std::numeric_limits<double>::infinity() && wall.in > end + gap_mm) break;
    end = std::max(end, wall.out);
  }
  if (!(end > start)) {
    for (const Vector3d& v : bone.vertices) end = std::max(end, into.dot(v));
  }
  return std::max(end - start, 0.0) + beyond_mm;
}

std::string free_name(const Operated& operated) {
  for (int i = 1;; ++i) {
    const std::string name = fmt::format("segment_{}", i);
    if (!operated.patient.bodies.find(name)) return name;
  }
}

/// The segment lies to the left of the line: reversed where that is the larger piece.
void take_smaller_piece(const Operated& operated, CutStep& cut) {
  const PlacedOsteotomy placed = place_osteotomy(operated.patient, cut);
  const CutResult made = cut_bone(closed_bone(drawn_part(operated, placed.part)).mesh, placed.cuts);
  double above = 0, below = 0;
  for (const Piece& piece : made.pieces)
    (segment_of(placed, piece) == 0 ? above : below) += piece.volume_mm3;
  auto& polyline = std::get<BentSheet>(cut.surfaces.front()).polyline;
  if (above > below) std::reverse(polyline.begin(), polyline.end());
}

}  // namespace

CutStep drawn_cut(const Operated& operated, const plan_edit::DrawCut& drawing) {
  if (drawing.points.size() < 2)
    throw InputError(
        fmt::format("a cut needs at least two points; {} drawn", drawing.points.size()));
  const Part& bone = drawn_part(operated, drawing.part);
  const Pose X_BC = operated.poses[bone.body].inverse();
  BentSheet sheet;
  for (const Vector3d& p : drawing.points) sheet.polyline.push_back(X_BC * p);
  sheet.direction = (X_BC.R * drawing.direction).normalized();
  sheet.depth_mm = drawing.depth_mm > 0 ? drawing.depth_mm : depth_of_wall(bone.mesh, sheet);
  CutStep cut;
  cut.target = operated.patient.bodies[bone.body].name;
  cut.bone = bone.name;
  cut.kerf_mm = drawing.kerf_mm;
  cut.surfaces = {sheet};
  cut.pieces = {free_name(operated)};
  take_smaller_piece(operated, cut);
  return cut;
}

CutStep with_point(const Operated& operated, CutStep cut, const plan_edit::MovePoint& edit) {
  const auto body = operated.patient.bodies.find(cut.target);
  if (!body || edit.surface >= cut.surfaces.size())
    throw InputError(fmt::format("the cut has no surface {}", edit.surface + 1));
  const Vector3d at = operated.poses[*body].inverse() * edit.at;
  if (auto* patch = std::get_if<PlanePatch>(&cut.surfaces[edit.surface])) {
    patch->point = at;
    return cut;
  }
  auto& polyline = std::get<BentSheet>(cut.surfaces[edit.surface]).polyline;
  if (edit.point >= polyline.size())
    throw InputError(fmt::format("the cut has no point {}", edit.point + 1));
  polyline[edit.point] = at;
  return cut;
}

std::vector<PlanHandle> point_handles(const Operated& operated, const CutStep& cut) {
  std::vector<PlanHandle> handles;
  const auto body = operated.patient.bodies.find(cut.target);
  if (!body) return handles;
  const Pose& X_CB = operated.poses[*body];
  const auto add = [&](std::size_t surface, std::size_t point, const Vector3d& p) {
    handles.push_back({.body = *body, .at = X_CB * p, .surface = surface, .point = point});
  };
  for (std::size_t s = 0; s < cut.surfaces.size(); ++s) {
    if (const auto* patch = std::get_if<PlanePatch>(&cut.surfaces[s])) {
      add(s, 0, patch->point);
    } else {
      const auto& polyline = std::get<BentSheet>(cut.surfaces[s]).polyline;
      for (std::size_t i = 0; i < polyline.size(); ++i) add(s, i, polyline[i]);
    }
  }
  return handles;
}

}  // namespace condyle
