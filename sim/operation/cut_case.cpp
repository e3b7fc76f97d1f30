#include "sim/operation/cut_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/similar_word.h"
#include "engine/mesh/measure.h"
#include "sim/case/case_format.h"
#include "sim/case/edit_bodies.h"
#include "sim/operation/closed_bone.h"
#include "sim/operation/cut_teeth.h"
#include "sim/operation/owners.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Pieces that move together.
struct Group {
  std::string body;  // its name
  std::string part;
  bool stays = false;
  TriMesh mesh = {};
  std::vector<int> source = {};
  std::vector<int> wall = {};
  double volume_mm3 = 0;
  int pieces = 0, slivers = 0;
  std::vector<CutSide> sides = {};  // by cut, where all pieces agree
};

void append(Group& group, const Piece& piece) {
  const auto add = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  const int offset = static_cast<int>(group.mesh.vertices.size());
  add(group.mesh.vertices, piece.mesh.vertices);
  add(group.mesh.colors, piece.mesh.colors);
  for (const auto& t : piece.mesh.triangles)
    group.mesh.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
  add(group.source, piece.source);
  add(group.wall, piece.wall);
  group.volume_mm3 += piece.volume_mm3;
  if (group.pieces == 0) group.sides = piece.sides;
  for (std::size_t i = 0; i < group.sides.size(); ++i)
    if (group.sides[i] != piece.sides[i]) group.sides[i] = CutSide::neither;
  ++group.pieces;
  if (piece.volume_mm3 < sliver_mm3) ++group.slivers;
}

/// What stays with the cut body, then one group per rule; some may be empty.
std::vector<Group> group_pieces(const Case& patient, const Part& bone, const CutResult& cut,
                                const PlacedOsteotomy& placed,
                                const std::vector<std::string>& names) {
  const std::string& body = patient.bodies[bone.body].name;
  std::vector<Group> groups{{.body = body, .part = bone.name, .stays = true}};
  std::vector<std::size_t> of_rule;
  for (const std::string& name : names) {
    if (name == body) {  // a piece that keeps the name of what is cut stays with it
      of_rule.push_back(0);
      continue;
    }
    of_rule.push_back(groups.size());
    groups.push_back({.body = name, .part = name});
  }
  for (const Piece& piece : cut.pieces) {
    const int rule = segment_of(placed, piece);
    append(groups[rule < 0 ? 0 : of_rule.at(rule)], piece);
  }
  return groups;
}

const Part& bone_of(const Case& patient, const std::string& name) {
  std::vector<std::string> bones;
  for (const Part& part : patient.parts) {
    if (part.name == name) return part;
    if (collides(part.role) && !is_teeth(part.role)) bones.push_back(part.name);
  }
  throw InputError(fmt::format("the patient has no bone \"{}\"{}; there are {}", name,
                               suggestion(name, bones), fmt::join(bones, ", ")));
}

/// Names of the groups' parts: of letters, digits, - and _, and unique. What stays makes room for a
/// segment of its name.
void name_parts(const Case& patient, std::vector<Group>& groups) {
  std::vector<std::string> taken;
  for (const Part& part : patient.parts)
    if (part.name != groups[0].part) taken.push_back(part.name);
  const auto is_taken = [&](const std::string& name) {
    return std::find(taken.begin(), taken.end(), name) != taken.end();
  };
  const auto unique = [&](std::string name, const char* suffix) {
    while (is_taken(name)) name += suffix;
    taken.push_back(name);
    return name;
  };
  for (std::size_t i = 1; i < groups.size(); ++i) {
    if (groups[i].pieces == 0) continue;
    std::string name = groups[i].body;
    for (char& c : name)
      if (!is_part_name(std::string(1, c))) c = '_';
    groups[i].part = unique(name, "_segment");
  }
  if (groups[0].pieces > 0) groups[0].part = unique(groups[0].part, "_rest");
}

/// Replaces the bone by the groups' meshes, and adds their bodies. The groups' own meshes remain.
void replace_bone(Case& patient, const std::string& bone, const std::vector<Group>& groups) {
  const auto at = std::find_if(patient.parts.begin(), patient.parts.end(),
                               [&](const Part& part) { return part.name == bone; });
  const BodyId parent = at->body;
  const Role role = at->role;
  std::vector<Part> made;
  for (const Group& group : groups) {
    if (group.pieces == 0) continue;
    const BodyId body =
        group.stays ? parent
                    : patient.bodies.add(
                          {.name = group.body, .parent = parent, .driver = BodyDriver::plan});
    made.push_back({group.part, group.stays ? role : Role::segment, group.mesh, {}, body});
  }
  const auto place = patient.parts.erase(at);
  patient.parts.insert(place, made.begin(), made.end());
}

using Renamed = std::map<std::string, std::vector<std::string>>;

/// Divides the teeth of the cut body among the groups.
void divide_teeth(Case& patient, BodyId cut_body, const std::vector<Group>& groups,
                  const NearestSurface& nearest, Renamed& renamed,
                  std::vector<std::string>& notes) {
  constexpr std::size_t samples = 400;
  for (std::size_t p = 0; p < patient.parts.size(); ++p) {
    const Part teeth = patient.parts[p];
    if (!is_teeth(teeth.role) || teeth.body != cut_body) continue;
    const auto items = arch_items(teeth);
    std::vector<int> of_item, used;
    for (const ArchItem& item : items) {
      double fraction = 0;
      const int group =
          nearest.of_most(sample_points(teeth.mesh, item.triangles, samples), &fraction);
      if (fraction <= 0.5)
        notes.push_back(fmt::format(
            "{} of {} lies in several pieces; it goes with {}, which holds {:.0f} % of it",
            item.fdi > 0 ? fmt::format("tooth {}", item.fdi) : "a tooth", teeth.name,
            groups[group].body, 100 * fraction));
      of_item.push_back(group);
    }
    for (std::size_t g = 0; g < groups.size(); ++g)
      if (std::count(of_item.begin(), of_item.end(), static_cast<int>(g)) > 0)
        used.push_back(static_cast<int>(g));
    if (used.size() == 1) {
      patient.parts[p].body = *patient.bodies.find(groups[used[0]].body);
      continue;
    }
    std::vector<Part> made;
    for (const int g : used) {
      Part part = items_of_part(teeth, items, of_item, g);
      part.body = *patient.bodies.find(groups[g].body);
      if (!groups[g].stays) part.name += "_" + groups[g].part;
      renamed[teeth.name].push_back(part.name);
      made.push_back(std::move(part));
    }
    const auto at = patient.parts.begin() + static_cast<std::ptrdiff_t>(p);
    patient.parts.insert(patient.parts.erase(at), made.begin(), made.end());
    p += made.size() - 1;
  }
}

std::vector<Vector3d> points_of(const Part& part, std::size_t most) {
  std::vector<int> triangles(part.mesh.triangles.size());
  std::iota(triangles.begin(), triangles.end(), 0);
  return sample_points(part.mesh, triangles, most);
}

/// Gives gums, tongue and canals of the cut body to the groups.
void assign_soft_parts(Case& patient, BodyId cut_body, const std::vector<Group>& groups,
                       const NearestSurface& nearest) {
  constexpr std::size_t samples = 2000;
  for (Part& part : patient.parts)
    if (part.body == cut_body && (part.role == Role::upper_gums || part.role == Role::lower_gums ||
                                  part.role == Role::tongue))
      part.body = *patient.bodies.find(groups[nearest.of_most(points_of(part, samples))].body);
  for (Canal& canal : patient.canals)
    if (canal.body == cut_body)
      canal.body = *patient.bodies.find(groups[nearest.of_most(canal.points)].body);
}

/// Gives bodies that the cut body carries to the groups: chins, grafts, but no jaw.
void assign_bodies(Case& patient, const std::string& cut_body, const std::vector<Group>& groups,
                   const NearestSurface& nearest) {
  constexpr std::size_t samples = 1000;
  std::vector<std::string> children;
  const BodyId parent = *patient.bodies.find(cut_body);
  for (const Body& body : patient.bodies.bodies()) {
    const bool is_new = std::any_of(groups.begin(), groups.end(),
                                    [&](const Group& group) { return group.body == body.name; });
    if (body.parent == parent && body.name != cut_body && !is_new &&
        body.driver != BodyDriver::motion)
      children.push_back(body.name);
  }
  for (const std::string& child : children) {
    std::vector<Vector3d> points;
    for (const BodyId body : patient.bodies.subtree(*patient.bodies.find(child)))
      for (const Part& part : patient.parts)
        if (part.body == body && collides(part.role)) {
          const auto more = points_of(part, samples);
          points.insert(points.end(), more.begin(), more.end());
        }
    const int group = nearest.of_most(points);
    if (group < 0 || groups[group].stays) continue;
    const BodyId body = *patient.bodies.find(child);
    const BodyId new_parent = *patient.bodies.find(groups[group].body);
    patient = with_parent(std::move(patient), body, new_parent);
  }
}

/// Rules of a part hold for all that it became; the pieces of a bone may touch.
void rewrite_rules(Case& patient, const Renamed& renamed, const std::vector<std::string>& pieces) {
  const auto now = [&](const std::string& name) {
    const auto found = renamed.find(name);
    return found == renamed.end() ? std::vector{name} : found->second;
  };
  std::vector<PairRule> rules;
  for (const PairRule& rule : patient.pair_rules)
    for (const std::string& a : now(rule.a))
      for (const std::string& b : now(rule.b)) {
        rules.push_back(rule);
        rules.back().a = a;
        rules.back().b = b;
      }
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (std::size_t j = i + 1; j < pieces.size(); ++j)
      rules.push_back({pieces[i], pieces[j], PairPolicy::cut_face, std::nullopt, 0});
  patient.pair_rules = std::move(rules);
}

/// Follows the faces of the groups to the uncut case.
void trace_faces(Operated& operated, const Part& bone, const ClosedBone& closed,
                 const std::vector<Group>& groups, int step) {
  std::optional<SurfaceOrigin> before;
  if (const auto known = operated.origin.find(bone.name); known != operated.origin.end()) {
    before = std::move(known->second);
    operated.origin.erase(known);
  }
  for (const Group& group : groups) {
    if (group.pieces == 0) continue;
    SurfaceOrigin origin{.part = before ? before->part : bone.name, .triangle = {}, .made_by = {}};
    for (const int face : group.source) {
      const int source = face < 0 ? -1 : closed.source[face];
      origin.triangle.push_back(source < 0 || !before ? source : before->triangle[source]);
      origin.made_by.push_back(face < 0                ? step
                               : source < 0 || !before ? 0
                                                       : before->made_by[source]);
    }
    operated.origin[group.part] = std::move(origin);
  }
}

/// throws: InputError naming a divided tooth, and the room between teeth where it is known.
void refuse_divided_teeth(const Case& patient, BodyId body, const PlacedOsteotomy& placed) {
  try {
    for (const Part& part : patient.parts)
      if (is_teeth(part.role) && part.body == body)
        refuse_divided_teeth(part, placed.cuts, placed.removed_teeth);
  } catch (const InputError& error) {
    if (placed.rooms.empty()) throw;
    throw InputError(fmt::format("{}; {}", error.what(), fmt::join(placed.rooms, "; ")));
  }
}

/// Remembers the saw cuts, and on which side of them each body lies.
void remember_sides(Operated& operated, const PlacedOsteotomy& placed, int step,
                    const std::string& cut_body, const std::vector<Group>& groups) {
  const std::size_t before = operated.saw_cuts.size();
  for (const Cut& cut : placed.cuts) operated.saw_cuts.push_back({step, cut});
  std::vector<CutSide> earlier = operated.sides[cut_body];
  earlier.resize(before, CutSide::neither);
  for (const Group& group : groups) {
    if (group.pieces == 0) continue;
    auto& sides = operated.sides[group.body] = earlier;
    sides.insert(sides.end(), group.sides.begin(), group.sides.end());
  }
}

CutReport report_of(const PlanStep& step, const Part& bone, const PlacedOsteotomy& placed,
                    const CutResult& cut, const std::vector<Group>& groups) {
  CutReport report;
  report.step = step.id;
  report.title = step_title(step.action);
  report.bone = bone.name;
  report.below_margins = std::get<CutStep>(step.action).below_margins;
  for (const Cut& each : placed.cuts) report.cuts.push_back(each.name);
  report.outcomes = cut.outcomes;
  report.crossings = cut.crossings;
  report.kerf_volume_mm3 = cut.kerf_volume_mm3;
  report.turned = cut.turned;
  report.notes = placed.notes;
  report.rooms = placed.rooms;
  for (const Group& group : groups)
    if (group.pieces > 0)
      report.pieces.push_back(
          {group.body, group.part, group.volume_mm3, group.pieces, group.slivers, group.stays});
  return report;
}

/// Gives what the bone carried to its pieces, which have replaced it.
void divide_soft_parts(Operated& operated, const Part& bone, const std::string& cut_body,
                       const std::vector<Group>& groups, std::vector<std::string>& notes) {
  Case& patient = operated.patient;
  NearestSurface nearest;
  Renamed renamed;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (groups[g].pieces == 0) continue;
    nearest.add(groups[g].mesh, static_cast<int>(g));
    renamed[bone.name].push_back(groups[g].part);
  }
  for (const Part& part : patient.parts) {  // other bones of the body hold their teeth
    const bool is_piece = std::any_of(groups.begin(), groups.end(), [&](const Group& group) {
      return group.pieces > 0 && group.part == part.name;
    });
    if (part.body == bone.body && !is_piece && collides(part.role) && !is_teeth(part.role))
      nearest.add(part.mesh, 0);
  }
  const auto pieces = renamed[bone.name];
  divide_teeth(patient, bone.body, groups, nearest, renamed, notes);
  assign_soft_parts(patient, bone.body, groups, nearest);
  assign_bodies(patient, cut_body, groups, nearest);
  rewrite_rules(patient, renamed, pieces);
}

void refuse_unparted(Operated& operated, const PlanStep& step, const std::vector<Group>& groups) {
  for (const Group& group : groups)
    if (group.pieces == 0 && !group.stays)
      operated.problems.push_back(
          fmt::format("{}: no piece is \"{}\": the cut does not part it from the bone",
                      step_name(step), group.body));
}

}  // namespace

std::vector<std::string> segment_names(const PlacedOsteotomy& placed, const CutStep& step) {
  std::vector<std::string> names;
  for (const SegmentRule& rule : placed.segments) names.push_back(rule.name);
  const bool own = std::all_of(step.pieces.begin(), step.pieces.end(), [&](const auto& piece) {
    return std::find(names.begin(), names.end(), piece) != names.end();
  });
  if (own) return names;
  if (step.pieces.size() > names.size())
    throw InputError(fmt::format("names {} pieces, but makes {}: {}", step.pieces.size(),
                                 names.size(), fmt::join(names, ", ")));
  std::copy(step.pieces.begin(), step.pieces.end(), names.begin());
  return names;
}

void cut_case(Operated& operated, const PlacedOsteotomy& placed, const PlanStep& step,
              CutScope scope) {
  Case& patient = operated.patient;
  const Part bone = bone_of(patient, placed.part);
  const std::string cut_body = patient.bodies[bone.body].name;
  const auto names = segment_names(placed, std::get<CutStep>(step.action));
  const ClosedBone closed = closed_bone(bone);
  const CutResult cut = cut_bone(closed.mesh, placed.cuts);
  std::vector<Group> groups = group_pieces(patient, bone, cut, placed, names);
  name_parts(patient, groups);
  CutReport report = report_of(step, bone, placed, cut, groups);
  report.notes.insert(report.notes.end(), closed.notes.begin(), closed.notes.end());
  report.volume_mm3 = signed_volume(closed.mesh);
  auto zones = danger_zones(patient, bone, !placed.rooms.empty());
  zones.insert(zones.end(), operated.own_zones.begin(), operated.own_zones.end());
  report.dangers = check_danger_zones(zones, cut.pieces);
  refuse_unparted(operated, step, groups);
  const bool met = std::any_of(cut.outcomes.begin(), cut.outcomes.end(),
                               [](const CutOutcome& outcome) { return outcome.meets_bone; });
  if (met) {
    refuse_divided_teeth(patient, bone.body, placed);
    trace_faces(operated, bone, closed, groups, step.id);
    remember_sides(operated, placed, step.id, cut_body, groups);
    replace_bone(patient, bone.name, groups);
    if (scope == CutScope::all) divide_soft_parts(operated, bone, cut_body, groups, report.notes);
  }
  operated.cuts.push_back(std::move(report));
}

}  // namespace condyle
