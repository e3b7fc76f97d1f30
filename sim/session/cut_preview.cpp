#include "sim/session/cut_preview.h"

#include <algorithm>
#include <map>
#include <utility>

#include "engine/core/error.h"
#include "engine/mesh/triangle_tree.h"
#include "sim/operation/closed_bone.h"
#include "sim/operation/cut_case.h"
#include "sim/operation/cut_text.h"
#include "sim/osteotomy/osteotomy.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Edges between faces that the step made and others.
std::vector<Vector3d> rims_of(const TriMesh& mesh, const SurfaceOrigin& origin, int step) {
  std::map<std::pair<int, int>, int> sides;  // bit 1: a cut face, bit 2: another
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(mesh.triangles[f][k], mesh.triangles[f][(k + 1) % 3]);
      sides[{a, b}] |= origin.made_by[f] == step ? 1 : 2;
    }
  std::vector<Vector3d> rims;
  for (const auto& [edge, bits] : sides)
    if (bits == 3) {
      rims.push_back(mesh.vertices[edge.first]);
      rims.push_back(mesh.vertices[edge.second]);
    }
  return rims;
}

/// The faces that a placed osteotomy cuts into its bone.
TriMesh cut_faces(const Operated& bones, const CutStep& cut) {
  const PlacedOsteotomy placed = place_osteotomy(bones.patient, cut);
  TriMesh faces;
  for (const Part& part : bones.patient.parts) {
    if (part.name != placed.part) continue;
    for (const Piece& piece : cut_bone(closed_bone(part).mesh, placed.cuts).pieces)
      for (std::size_t f = 0; f < piece.mesh.triangles.size(); ++f) {
        if (piece.source[f] >= 0) continue;
        const int first = static_cast<int>(faces.vertices.size());
        for (int k = 0; k < 3; ++k)
          faces.vertices.push_back(piece.mesh.vertices[piece.mesh.triangles[f][k]]);
        faces.triangles.emplace_back(first, first + 1, first + 2);
      }
  }
  return faces;
}

struct Shift {
  Vector3d from = Vector3d::Zero(), to = Vector3d::Zero();
  double length() const { return (to - from).norm(); }
};

/// Where faces lie farthest from others. Of places that are nearly as far, one that keeps away from
/// handles already placed.
Shift farthest(const TriMesh& faces, const TriMesh& others, const std::vector<PlanHandle>& placed) {
  constexpr std::size_t most_samples = 3000;
  constexpr double near_mm = 6, nearly = 0.8;
  const TriangleTree tree(others);
  std::vector<Shift> shifts;
  const std::size_t step = std::max<std::size_t>(1, faces.vertices.size() / most_samples);
  double most = 0;
  for (std::size_t i = 0; i < faces.vertices.size(); i += step) {
    const Shift shift{faces.vertices[i], tree.nearest(faces.vertices[i]).point};
    most = std::max(most, shift.length());
    shifts.push_back(shift);
  }
  Shift best;
  double best_room = -1;
  for (const Shift& shift : shifts) {
    if (shift.length() < nearly * most) continue;
    double room = near_mm;
    for (const PlanHandle& handle : placed) room = std::min(room, (handle.at - shift.from).norm());
    if (room > best_room || (room == best_room && shift.length() > best.length())) {
      best = shift;
      best_room = room;
    }
  }
  return best;
}

/// How a number moves a cut face.
struct NumberEffect {
  Vector3d at = Vector3d::Zero(), per_unit = Vector3d::Zero();
  double held_back = 0;  // change of the number before the face begins to move
};

/// Where the faces of a cut move farthest with a number, from cuts whose number is changed by one
/// and by two steps: danger zones may hold it back at first. None where it cannot be placed.
std::optional<NumberEffect> effect_of(const TriMesh& now, const Operated& bones, CutStep cut,
                                      const std::string& number, double value, double step,
                                      const std::vector<PlanHandle>& placed) {
  try {
    cut.parameters[number] = value + step;
    const TriMesh one = cut_faces(bones, cut);
    cut.parameters[number] = value + 2 * step;
    const TriMesh two = cut_faces(bones, cut);
    if (one.empty() || two.empty()) return std::nullopt;
    Shift shift = farthest(now, two, placed), back = farthest(two, now, placed);
    std::swap(back.from, back.to);
    if (back.length() > shift.length()) shift = back;
    const double first = TriangleTree(one).nearest(shift.from).distance,
                 second = TriangleTree(two).nearest(shift.from).distance;
    const double slope = (second - first) / std::abs(step);
    if (!(slope > 0)) return std::nullopt;
    const double sign = step > 0 ? 1 : -1;
    return NumberEffect{shift.from, sign * slope * (shift.to - shift.from).normalized(),
                        step - sign * first / slope};
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

const Operated& CutPreviewer::before(const Plan& plan, int step) {
  Plan earlier = plan;
  const auto at = std::find_if(earlier.steps.begin(), earlier.steps.end(),
                               [&](const PlanStep& each) { return each.id == step; });
  earlier.steps.erase(at, earlier.steps.end());
  std::erase_if(earlier.steps, [](const PlanStep& each) {
    return !std::holds_alternative<CutStep>(each.action) &&
           !std::holds_alternative<ResectStep>(each.action);
  });
  if (!earlier_ || !(*earlier_ == earlier)) {
    earlier_.reset();
    bones_ = apply_cuts(*uncut_, earlier);
    earlier_ = std::move(earlier);
  }
  return bones_;
}

CutPreview CutPreviewer::preview(const Plan& plan, int id) {
  CutPreview preview;
  try {
    const PlanStep& step = step_of(plan, id);
    const auto& cut = std::get<CutStep>(step.action);
    Operated bones = before(plan, id);
    const std::size_t problems = bones.problems.size();
    cut_case(bones, place_osteotomy(bones.patient, cut), step, CutScope::bone);
    CutReport& report = bones.cuts.back();
    drop_resected_zones(bones, report.dangers);
    preview.words.findings = cut_sentences(report, bones.patient.landmarks);
    preview.words.warns = report.needs_attention();
    if (bones.problems.size() > problems)
      preview.words.problem = "the cut does not separate a piece of the bone";
    for (const CutPiece& piece : report.pieces)
      for (const Part& part : bones.patient.parts) {
        const auto origin = bones.origin.find(part.name);
        if (part.name != piece.part || origin == bones.origin.end()) continue;
        preview.pieces.push_back(
            {piece.body, piece.stays, part.mesh, rims_of(part.mesh, origin->second, id)});
      }
    for (const Part& part : bones_.patient.parts)
      if (part.name == report.bone) preview.body = bones_.patient.bodies[part.body].name;
  } catch (const InputError& error) {
    preview.words.problem = error.what();
  }
  return preview;
}

std::vector<PlanHandle> CutPreviewer::number_handles(const Plan& plan, int id, std::string& body) {
  constexpr double step = 2, least_mm = 0.2;  // of the number; displacement for one unit
  std::vector<PlanHandle> handles;
  const auto cut = std::get<CutStep>(step_of(plan, id).action);
  if (cut.osteotomy.empty() || !cut.surfaces.empty()) return handles;
  try {
    const Operated& bones = before(plan, id);
    const TriMesh now = cut_faces(bones, cut);
    if (now.empty()) return handles;
    const PlacedOsteotomy placed = place_osteotomy(bones.patient, cut);
    for (const Part& part : bones.patient.parts)
      if (part.name == placed.part) body = bones.patient.bodies[part.body].name;
    for (const OsteotomyParameter& parameter : osteotomy_parameters(cut.osteotomy)) {
      // A number of pieces or a choice; a margin, which moves a cut only where it holds it back.
      if (parameter.unit.empty() || parameter.name.ends_with("_margin_mm")) continue;
      // Larger, or smaller where that is impossible or danger zones keep the cut in its place.
      const auto set = cut.parameters.find(parameter.name);
      const double value = set == cut.parameters.end() ? parameter.standard : set->second;
      const auto station =
          std::find_if(placed.stations.begin(), placed.stations.end(),
                       [&](const CutStation& each) { return each.parameter == parameter.name; });
      if (station != placed.stations.end()) {
        handles.push_back({.at = station->at,
                           .number = parameter.name,
                           .per_unit = station->per_unit,
                           .value = value});
        continue;
      }
      for (const double change : {step, -step}) {
        if (value + 2 * change > parameter.high || value + 2 * change < parameter.low) continue;
        const auto effect = effect_of(now, bones, cut, parameter.name, value, change, handles);
        if (!effect || effect->per_unit.norm() < least_mm) continue;
        handles.push_back({.at = effect->at,
                           .number = parameter.name,
                           .per_unit = effect->per_unit,
                           .value = value + effect->held_back});
        break;
      }
    }
  } catch (const InputError&) {
    handles.clear();
  }
  return handles;
}

}  // namespace condyle
