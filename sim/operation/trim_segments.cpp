#include "sim/operation/trim_segments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "sim/operation/cut_teeth.h"
#include "sim/operation/segment_overlaps.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

CutSide side_of(const Operated& operated, const std::string& body, std::size_t saw_cut) {
  const auto found = operated.sides.find(body);
  if (found == operated.sides.end() || saw_cut >= found->second.size()) return CutSide::neither;
  return found->second[saw_cut];
}

/// The side of a saw cut on which a segment lies, without the kerf, within the cut's reach.
Region side_region(const Cut& cut, CutSide side) {
  const bool above = side == CutSide::above;
  Region region = cut.above.with_planes([&](const Region::Leaf& leaf) {
    const double shift = leaf.wall < 0 ? 0 : (above ? 0.5 : -0.5) * cut.kerf_mm;
    return Plane{leaf.plane.normal, leaf.plane.offset_mm + shift};
  });
  if (!above) region = opposite(std::move(region));
  for (const Plane& end : cut.reach)
    region = both(Region::above({-end.normal, -end.offset_mm}), std::move(region));
  return region;
}

Region moved_region(const Region& region, const Pose& X) {
  return region.with_planes([&](const Region::Leaf& leaf) {
    const Vector3d normal = (X.R * leaf.plane.normal).normalized();
    return Plane{normal, leaf.plane.offset_mm + normal.dot(X.t)};
  });
}

/// The space beyond the cut faces of `other`, in the frame of `segment` at its uncut rest; absent
/// where no saw cut runs between the two.
std::optional<Region> space_of(const Operated& operated, const std::string& other,
                               const std::string& segment) {
  std::optional<Region> space;
  for (std::size_t i = 0; i < operated.saw_cuts.size(); ++i) {
    const CutSide theirs = side_of(operated, other, i), own = side_of(operated, segment, i);
    if (theirs == CutSide::neither || own == CutSide::neither || theirs == own) continue;
    Region side = side_region(operated.saw_cuts[i].cut, theirs);
    space = space ? both(std::move(*space), std::move(side)) : std::move(side);
  }
  if (!space) return std::nullopt;
  const BodyTree& bodies = operated.patient.bodies;
  const Pose X_SO =
      operated.poses[*bodies.find(segment)].inverse() * operated.poses[*bodies.find(other)];
  return moved_region(*space, X_SO);
}

bool is_in(const Region& region, const Vector3d& p) {
  std::vector<Region::Side> sides;
  for (const auto& leaf : region.leaves())
    sides.push_back(leaf.plane.distance(p) > 0 ? Region::Side::upper : Region::Side::lower);
  return region.evaluate(sides).inside;
}

/// The first tooth of a body of which more than a hundredth lies in the regions; empty: none.
std::string tooth_in(const Case& patient, BodyId body, const std::vector<Cut>& cuts) {
  constexpr double grazed = 0.01;
  for (const Part& part : patient.parts) {
    if (!is_teeth(part.role) || part.body != body) continue;
    for (const ArchItem& item : arch_items(part)) {
      const auto points = sample_points(part.mesh, item.triangles, 4 * item.triangles.size());
      const auto count = std::count_if(points.begin(), points.end(), [&](const Vector3d& p) {
        return std::any_of(cuts.begin(), cuts.end(),
                           [&](const Cut& cut) { return is_in(cut.above, p); });
      });
      if (static_cast<double>(count) > grazed * static_cast<double>(points.size()))
        return item.fdi > 0 ? fmt::format("tooth {}", item.fdi) : "a tooth of " + part.name;
    }
  }
  return "";
}

/// Segments of the step that overlap with its own at the planned positions.
std::vector<std::string> overlapping(const Operated& operated, const TrimStep& step) {
  std::vector<std::string> kept;
  for (const std::string& other : step.of)
    if (cut_bones_overlap(operated, step.segment, other)) kept.push_back(other);
  return kept;
}

/// What remains of a bone, and what was removed.
struct Trimmed {
  Piece rest;
  std::vector<double> removed_mm3;  // by cut
  double fragments_mm3 = 0;
  int fragments = 0, pieces = 0;
};

void append(Piece& rest, const Piece& piece) {
  const int offset = static_cast<int>(rest.mesh.vertices.size());
  const auto add = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  add(rest.mesh.vertices, piece.mesh.vertices);
  add(rest.mesh.colors, piece.mesh.colors);
  for (const auto& t : piece.mesh.triangles)
    rest.mesh.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
  add(rest.source, piece.source);
  add(rest.wall, piece.wall);
  rest.volume_mm3 += piece.volume_mm3;
}

Trimmed trimmed_bone(const TriMesh& mesh, const std::vector<Cut>& cuts) {
  const CutResult result = cut_bone(mesh, cuts);
  Trimmed trimmed;
  trimmed.removed_mm3.assign(cuts.size(), 0);
  for (const Piece& piece : result.pieces) {
    const auto in = std::find(piece.sides.begin(), piece.sides.end(), CutSide::above);
    if (in != piece.sides.end()) {
      trimmed.removed_mm3[static_cast<std::size_t>(in - piece.sides.begin())] += piece.volume_mm3;
      continue;
    }
    // The trim made it where it touches one of its faces.
    const bool is_new =
        std::any_of(piece.wall.begin(), piece.wall.end(), [](int wall) { return wall >= 0; });
    if (trimmed.pieces > 0 && is_new && piece.volume_mm3 < sliver_mm3) {
      trimmed.fragments_mm3 += piece.volume_mm3;
      ++trimmed.fragments;
      continue;
    }
    append(trimmed.rest, piece);
    ++trimmed.pieces;
  }
  return trimmed;
}

/// The cut bone of a body.
Part* bone_of_body(Operated& operated, BodyId body) {
  for (Part& part : operated.patient.parts)
    if (part.body == body && operated.origin.contains(part.name)) return &part;
  return nullptr;
}

void replace_surface(Part& bone, SurfaceOrigin& origin, const Trimmed& trimmed, int step) {
  SurfaceOrigin now{.part = origin.part, .triangle = {}, .made_by = {}};
  for (const int face : trimmed.rest.source) {
    now.triangle.push_back(face < 0 ? -1 : origin.triangle[face]);
    now.made_by.push_back(face < 0 ? step : origin.made_by[face]);
  }
  origin = std::move(now);
  bone.mesh = trimmed.rest.mesh;
}

/// The cuts of a step, one for each segment that it gives way to.
std::vector<Cut> cuts_of(Operated& operated, const std::vector<std::string>& others,
                         const TrimStep& step, TrimReport& report, const std::string& name) {
  std::vector<Cut> cuts;
  for (const std::string& other : others) {
    const auto space = space_of(operated, other, step.segment);
    if (!space) {
      operated.problems.push_back(
          fmt::format("{}: no saw cut runs between {} and {}", name, step.segment, other));
      continue;
    }
    cuts.push_back({other, *space, {}, 0});
    report.shares.push_back({other, 0});
  }
  return cuts;
}

void replay_trim(Operated& operated, const PlanStep& plan_step) {
  const auto& step = std::get<TrimStep>(plan_step.action);
  const std::string name = step_name(plan_step);
  const auto problem = [&](const std::string& text) {
    operated.problems.push_back(name + ": " + text);
  };
  const BodyTree& bodies = operated.patient.bodies;
  std::vector<std::string> all = step.of;
  all.push_back(step.segment);
  for (const std::string& body : all)
    if (!bodies.find(body))
      return problem("\"" + body + "\" does not exist, so nothing is trimmed");
  const BodyId body = *bodies.find(step.segment);
  Part* bone = bone_of_body(operated, body);
  if (!bone) return problem("no saw cut made bone of \"" + step.segment + "\"");
  TrimReport report;
  report.step = plan_step.id;
  report.title = step_title(plan_step.action);
  report.segment = step.segment;
  report.part = bone->name;
  report.below_margins = step.below_margins;
  report.before_mm3 = report.after_mm3 = signed_volume(bone->mesh);
  const auto cuts = cuts_of(operated, overlapping(operated, step), step, report, name);
  if (cuts.empty()) {
    report.notes.push_back("nothing overlaps at the planned positions, so nothing is removed");
  } else if (const std::string tooth = tooth_in(operated.patient, body, cuts); !tooth.empty()) {
    problem(fmt::format("{} lies in the bone that would be removed", tooth));
    report.shares.clear();
  } else {
    const Trimmed trimmed = trimmed_bone(bone->mesh, cuts);
    if (trimmed.pieces == 0) return problem("nothing of \"" + step.segment + "\" would be left");
    for (std::size_t i = 0; i < cuts.size(); ++i)
      report.shares[i].volume_mm3 = trimmed.removed_mm3[i];
    report.fragments = trimmed.fragments;
    report.fragments_mm3 = trimmed.fragments_mm3;
    report.pieces = trimmed.pieces;
    report.after_mm3 = trimmed.rest.volume_mm3;
    auto zones = danger_zones(operated.patient, *bone);
    zones.insert(zones.end(), operated.own_zones.begin(), operated.own_zones.end());
    report.dangers = check_danger_zones(zones, {trimmed.rest});
    replace_surface(*bone, operated.origin.at(bone->name), trimmed, plan_step.id);
  }
  operated.trims.push_back(std::move(report));
}

}  // namespace

double TrimReport::removed_mm3() const {
  double sum = fragments_mm3;
  for (const Share& share : shares) sum += share.volume_mm3;
  return sum;
}

bool TrimReport::is_dangerous() const {
  return std::any_of(dangers.begin(), dangers.end(), [](const DangerFinding& finding) {
    return finding.level == DangerLevel::stop;
  });
}

double TrimReport::volume_error_percent() const {
  return before_mm3 > 0 ? 100 * std::abs(after_mm3 + removed_mm3() - before_mm3) / before_mm3 : 0;
}

void trim_segments(Operated& operated, const Plan& plan) {
  for (const PlanStep& step : plan.steps)
    if (std::holds_alternative<TrimStep>(step.action)) replay_trim(operated, step);
}

std::vector<std::string> trimming_segments(const Operated& operated, const std::string& segment) {
  std::vector<std::string> others;
  const auto is_bone = [&](const std::string& part) { return operated.origin.contains(part); };
  for (const SegmentOverlap& overlap : body_overlaps(operated, segment)) {
    if (overlap.kind != SegmentOverlap::Kind::trimmed || !is_bone(overlap.a) || !is_bone(overlap.b))
      continue;
    const bool first = overlap.body_a == segment;
    const std::string& other = first ? overlap.body_b : overlap.body_a;
    if (std::find(others.begin(), others.end(), other) == others.end()) others.push_back(other);
  }
  return others;
}

std::vector<std::string> trim_sentences(const TrimReport& report) {
  std::vector<std::string> sentences;
  for (const auto& share : report.shares)
    sentences.push_back(
        fmt::format("{:.0f} mm³ removed beyond the cut faces of {}", share.volume_mm3, share.of));
  if (report.fragments > 0)
    sentences.push_back(fmt::format("{} loose fragment{} removed, {:.0f} mm³", report.fragments,
                                    report.fragments == 1 ? "" : "s", report.fragments_mm3));
  for (const DangerFinding& finding : report.dangers)
    if (finding.level != DangerLevel::clear) sentences.push_back(danger_text(finding));
  if (report.is_dangerous())
    sentences.push_back(
        report.below_margins
            ? "lies below the least margins, on request"
            : "lies below the least margins, although the step does not ask for it");
  sentences.push_back(
      fmt::format("{}: {:.1f} cm³ left{}", report.segment, report.after_mm3 / 1000,
                  report.pieces > 1 ? fmt::format(", {} separate pieces", report.pieces) : ""));
  sentences.insert(sentences.end(), report.notes.begin(), report.notes.end());
  return sentences;
}

}  // namespace condyle
