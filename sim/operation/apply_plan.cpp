#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "sim/operation/cut_case.h"
#include "sim/operation/graft_steps.h"
#include "sim/operation/operation.h"
#include "sim/operation/owners.h"
#include "sim/operation/trim_segments.h"
#include "sim/osteotomy/osteotomy.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

std::string joined(const std::vector<std::string>& items) {
  return fmt::format("{}", fmt::join(items, ", "));
}

/// Refuses a plan of another case; landmarks that changed are notes.
void check_case(const Case& patient, const Plan& plan, std::vector<std::string>& notes) {
  const CaseComparison found = compare_geometry(plan.geometry, geometry_of(patient));
  if (found.match == CaseMatch::other_case)
    throw InputError(fmt::format("the plan \"{}\" was made for another case, \"{}\": here {}",
                                 plan.name, plan.geometry.name, joined(found.differences)));
  for (const std::string& difference : found.differences)
    notes.push_back(fmt::format("since the plan was made, the landmark {}", difference));
}

void replay_cut(Operated& operated, const PlanStep& step) {
  const auto& cut = std::get<CutStep>(step.action);
  if (!cut.target.empty() && !operated.patient.bodies.find(cut.target)) {
    operated.problems.push_back(
        fmt::format("{}: \"{}\" does not exist, so it is not cut", step_name(step), cut.target));
    return;
  }
  try {
    cut_case(operated, place_osteotomy(operated.patient, cut), step);
  } catch (const InputError& error) {
    throw InputError(step_name(step) + ": " + error.what());
  }
}

/// Middle of the bones of a body and of all that was cut from it, by volume.
Vector3d centroid_of(const Case& patient, BodyId body) {
  double volume = 0;
  Vector3d moment = Vector3d::Zero();
  Box box;
  for (const BodyId each : patient.bodies.subtree(body))
    for (const Part& part : patient.parts) {
      if (part.body != each || !collides(part.role) || is_teeth(part.role)) continue;
      box.add(bounding_box(part.mesh));
      const Vector3d middle = bounding_box(part.mesh).center();
      for (const auto& t : part.mesh.triangles) {
        const Vector3d a = part.mesh.vertices[t[0]] - middle, b = part.mesh.vertices[t[1]] - middle,
                       c = part.mesh.vertices[t[2]] - middle;
        const double six = a.dot(b.cross(c));
        volume += six;
        moment += six * (middle + (a + b + c) / 4);
      }
    }
  if (box.empty()) return Vector3d::Zero();
  return std::abs(volume) > 1 ? Vector3d(moment / volume) : box.center();
}

/// The planned pose of each body that a step moves, from the uncut rest: of several the last.
std::map<BodyId, Pose> find_moves(const Plan& plan, Operated& operated) {
  const Case& patient = operated.patient;
  std::map<std::string, const PlanStep*> last;
  for (const PlanStep& step : plan.steps)
    if (const auto* move = std::get_if<MoveStep>(&step.action)) last[move->segment] = &step;
  std::optional<ClinicalFrame> frame;
  std::map<BodyId, Pose> moves;
  for (const auto& [segment, step] : last) {
    const auto body = patient.bodies.find(segment);
    if (!body) {
      operated.problems.push_back(
          fmt::format("{}: \"{}\" does not exist, so it is not moved", step_name(*step), segment));
      continue;
    }
    if (*body == cranium_body)
      throw InputError(step_name(*step) +
                       ": the cranium is the frame of all moves; cut a segment "
                       "from it, and move that");
    const auto& action = std::get<MoveStep>(step->action);
    const Vector3d centroid = centroid_of(patient, *body);
    try {
      if (const auto* given = std::get_if<ExplicitMove>(&action.move)) {
        check_move(given->X_CS, centroid);
        moves[*body] = given->X_CS;
        continue;
      }
      const auto& move = std::get<ClinicalMove>(action.move);
      if (!frame) {
        frame = clinical_frame(patient.landmarks, plan.reference);
        operated.notes.insert(operated.notes.end(), frame->notes.begin(), frame->notes.end());
      }
      moves[*body] = move_pose(move, *frame, point_of(move, segment, patient.landmarks, centroid));
    } catch (const InputError& error) {
      throw InputError(step_name(*step) + ": " + error.what());
    }
  }
  return moves;
}

void pose_bodies(const Plan& plan, Operated& operated) {
  const auto moves = find_moves(plan, operated);
  const BodyTree& tree = operated.patient.bodies;
  BodyPoses& at = operated.poses;
  at.X_CB = {Pose{}};
  for (int b = 1; b < tree.size(); ++b) {
    const BodyId body{b}, parent = tree[body].parent;
    const auto move = moves.find(body);
    at.X_CB.push_back(move == moves.end() ? at[parent] : move->second);
    if (move != moves.end() && !bit_identical(at[parent], {}))
      operated.notes.push_back(fmt::format(
          "{}: its move counts from the uncut rest, not from the planned position of the {}",
          tree[body].name, tree[parent].name));
  }
  operated.X_PB = in_parents(tree, at);
}

TriMesh moved_mesh(TriMesh mesh, const Pose& X) {
  for (Vector3d& v : mesh.vertices) v = X * v;
  return mesh;
}

/// Landmarks of a jaw that moves, whether or not its bone is there.
bool measures_motion(const std::string& landmark) {
  return landmark == "lower_incisal_point" || landmark == "upper_incisal_point" ||
         landmark == "left_condyle" || landmark == "right_condyle";
}

}  // namespace

bool CutReport::is_dangerous() const {
  return std::any_of(dangers.begin(), dangers.end(), [](const DangerFinding& finding) {
    return finding.level == DangerLevel::stop;
  });
}

bool CutReport::needs_attention() const {
  return is_dangerous() ||
         std::any_of(outcomes.begin(), outcomes.end(), [](const CutOutcome& outcome) {
           return !outcome.open_on_purpose && !outcome.through;
         });
}

double CutReport::volume_error_percent() const {
  double sum = kerf_volume_mm3;
  for (const CutPiece& piece : pieces) sum += piece.volume_mm3;
  return volume_mm3 > 0 ? 100 * std::abs(sum - volume_mm3) / volume_mm3 : 0;
}

void drop_resected_zones(const Operated& operated, std::vector<DangerFinding>& findings) {
  std::set<std::string> zones;
  for (const Resection& resection : operated.resections)
    for (const int fdi : resection.teeth) zones.insert(fmt::format("tooth {}", fdi));
  for (std::string name : operated.resected_landmarks) {
    std::replace(name.begin(), name.end(), '_', ' ');
    zones.insert(std::move(name));
  }
  for (const DangerZone& own : operated.own_zones) zones.erase(own.name);
  std::erase_if(findings, [&](const DangerFinding& finding) {
    return (finding.kind == ZoneKind::tooth || finding.kind == ZoneKind::foramen) &&
           zones.contains(finding.zone);
  });
}

Operated apply_plan(const Case& patient, const Plan& plan) {
  return with_moves(apply_cuts(patient, plan), plan);
}

Operated apply_cuts(const Case& patient, const Plan& plan) {
  Operated operated;
  check_plan(plan);
  check_segments(plan, patient.bodies);
  check_case(patient, plan, operated.notes);
  operated.patient = patient;
  for (const PlanZone& zone : plan.zones) operated.own_zones.push_back(own_zone(zone));
  for (const PlanStep& step : plan.steps) {
    if (std::holds_alternative<CutStep>(step.action)) replay_cut(operated, step);
    if (std::holds_alternative<ResectStep>(step.action)) resect_segment(operated, step);
  }
  const OwnerFinder finder(patient, operated.patient);
  operated.owners = landmark_owners(patient, finder);
  operated.resected_landmarks = resected_landmarks(patient, finder, operated);
  for (CutReport& cut : operated.cuts) drop_resected_zones(operated, cut.dangers);
  operated.muscles = muscle_owners(patient, finder);
  operated.patient.jaw = jaw_bodies(patient, operated.patient, finder);
  for (const PlanStep& step : plan.steps)  // what was there owns landmarks and muscles
    if (std::holds_alternative<GraftStep>(step.action)) place_graft(operated, plan, step);
  operated.poses.X_CB.assign(static_cast<std::size_t>(operated.patient.bodies.size()), Pose{});
  operated.X_PB = in_parents(operated.patient.bodies, operated.poses);
  return operated;
}

Operated with_moves(Operated cuts, const Plan& plan) {
  check_plan(plan);
  pose_bodies(plan, cuts);
  trim_segments(cuts, plan);
  for (TrimReport& trim : cuts.trims) drop_resected_zones(cuts, trim.dangers);
  return cuts;
}

bool have_same_cuts(const Plan& a, const Plan& b) {
  const auto moves = [](const PlanStep& step) {
    return std::holds_alternative<MoveStep>(step.action) ||
           std::holds_alternative<NoteStep>(step.action);
  };
  const auto others_of = [&](const Plan& plan) {
    std::vector<PlanStep> others = plan.steps;
    std::erase_if(others, moves);
    return others;
  };
  const auto trims = [](const PlanStep& step) {
    return std::holds_alternative<TrimStep>(step.action);  // what it removes depends on the moves
  };
  return a.name == b.name && a.geometry == b.geometry && a.reference == b.reference &&
         a.zones == b.zones && std::none_of(a.steps.begin(), a.steps.end(), trims) &&
         others_of(a) == others_of(b);
}

Pose planned_pose(const Operated& operated, const Plan& plan, const MoveStep& step) {
  const Case& patient = operated.patient;
  const auto body = patient.bodies.find(step.segment);
  if (!body) throw InputError(fmt::format("\"{}\" does not exist", step.segment));
  const Vector3d centroid = centroid_of(patient, *body);
  if (const auto* given = std::get_if<ExplicitMove>(&step.move)) {
    check_move(given->X_CS, centroid);
    return given->X_CS;
  }
  const auto& move = std::get<ClinicalMove>(step.move);
  return move_pose(move, clinical_frame(patient.landmarks, plan.reference),
                   point_of(move, step.segment, patient.landmarks, centroid));
}

Vector3d rotation_point(const Operated& operated, const std::string& segment,
                        const ClinicalMove& move) {
  const Case& patient = operated.patient;
  const auto body = patient.bodies.find(segment);
  if (!body) throw InputError(fmt::format("\"{}\" does not exist", segment));
  return point_of(move, segment, patient.landmarks, centroid_of(patient, *body));
}

Landmarks planned_landmarks(const Operated& operated) {
  return landmarks_at(operated, operated.poses);
}

Landmarks landmarks_at(const Operated& operated, const BodyPoses& poses) {
  return moved_landmarks(present_landmarks(operated), operated.owners,
                         completed(operated.patient.bodies, poses));
}

MovementTable planned_movements(const Operated& operated, const ClinicalFrame& frame) {
  return movements_at(operated, frame, operated.poses);
}

Landmarks present_landmarks(const Operated& operated) {
  Landmarks present = operated.patient.landmarks;
  for (const std::string& name : operated.resected_landmarks) present.points.erase(name);
  return present;
}

MovementTable movements_at(const Operated& operated, const ClinicalFrame& frame,
                           const BodyPoses& poses) {
  return movement_table(present_landmarks(operated), frame, operated.patient.bodies,
                        operated.owners, poses);
}

Case operated_case(const Operated& operated) {
  Case patient = operated.patient;
  for (const std::string& name : operated.resected_landmarks)
    if (!measures_motion(name)) patient.landmarks.points.erase(name);
  std::erase_if(patient.tissue.attachments, [&](const AttachmentRegion& region) {
    const bool gone = !region.landmark.empty() && !patient.landmarks.find(region.landmark) &&
                      operated.resected_landmarks.contains(region.landmark);
    if (gone)
      patient.notes.push_back(
          fmt::format("the attachment of soft tissue around {} is left out: its bone is resected",
                      region.landmark));
    return gone;
  });
  const BodyPoses& at = operated.poses;
  const auto is_moved = [&](BodyId body) { return !bit_identical(at[body], {}); };
  bool moved = false;
  for (Part& part : patient.parts) {
    if (!is_rigid(part.role) || !is_moved(part.body)) continue;
    part.mesh = moved_mesh(std::move(part.mesh), at[part.body]);
    moved = true;
  }
  if (!moved) return patient;
  for (auto& [name, point] : patient.landmarks.points)
    if (const auto owner = operated.owners.find(name);
        owner != operated.owners.end() && is_moved(owner->second))
      point = at[owner->second] * point;
  for (Canal& canal : patient.canals)
    if (is_moved(canal.body))
      for (Vector3d& p : canal.points) p = at[canal.body] * p;
  for (std::size_t i = 0; i < patient.muscles.size(); ++i) {
    Muscle& muscle = patient.muscles[i];
    const auto [origin, insertion] = operated.muscles[i];
    if (is_moved(origin)) muscle.origin = at[origin] * muscle.origin;
    if (is_moved(insertion)) muscle.insertion = at[insertion] * muscle.insertion;
  }
  patient.notes.push_back("the bones lie as planned; the face is as before the operation");
  return patient;
}

}  // namespace condyle
