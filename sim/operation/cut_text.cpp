#include "sim/operation/cut_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "sim/operation/segment_overlaps.h"

namespace condyle {
namespace {

std::string outcome_words(const std::string& cut, const CutOutcome& outcome,
                          const Landmarks& landmarks) {
  if (!outcome.meets_bone) return cut + ": does not meet the bone";
  if (outcome.open_on_purpose)
    return fmt::format("{}: ends in the bone on purpose, {:.0f} mm² of cut faces", cut,
                       outcome.wall_area_mm2);
  if (!outcome.through)
    return fmt::format("{}: does not go through: {:.1f} mm of bone left at {}", cut,
                       outcome.left_mm, place_words(outcome.left_at, landmarks));
  return fmt::format("{}: goes through, {:.0f} mm² of cut faces", cut, outcome.wall_area_mm2);
}

/// Says of a cut below the least margins whether the plan asks for it.
std::string margin_words(const CutReport& report) {
  if (report.below_margins)
    return report.is_dangerous() ? "lies below the least margins, on request"
                                 : "keeps the least margins, although the step may lie below them";
  return report.is_dangerous()
             ? "lies below the least margins, although the step does not ask for it"
             : "";
}

std::string piece_words(const CutPiece& piece) {
  std::string words = fmt::format("{}: {:.1f} cm³{}", piece.body, piece.volume_mm3 / 1000,
                                  piece.stays ? ", stays" : "");
  if (piece.pieces > 1) words += fmt::format(", {} separate pieces", piece.pieces);
  if (piece.slivers > 0) words += fmt::format(", {} below {:g} mm³", piece.slivers, sliver_mm3);
  return words;
}

/// What a cut step says of itself besides its title: "kerf 0.7 mm; height 5".
std::string cut_details(const CutStep& step) {
  std::string text = step.pieces.empty() ? std::string("no segments by name")
                                         : fmt::format("makes {}", fmt::join(step.pieces, ", "));
  if (!step.osteotomy.empty() && !step.target.empty()) text += "; of " + step.target;
  if (step.kerf_mm > 0) text += fmt::format("; kerf {:g} mm", step.kerf_mm);
  for (const auto& [name, value] : step.parameters) text += fmt::format("; {} {:g}", name, value);
  if (step.below_margins) text += "; below the least margins on request";
  return text;
}

}  // namespace

std::vector<std::string> cut_sentences(const CutReport& report, const Landmarks& landmarks) {
  std::vector<std::string> sentences;
  for (std::size_t i = 0; i < report.outcomes.size(); ++i)
    sentences.push_back(outcome_words(report.cuts[i], report.outcomes[i], landmarks));
  for (std::size_t i = 0; i < report.outcomes.size(); ++i)
    for (const CutWindow& window : report.outcomes[i].windows)
      sentences.push_back(fmt::format("{}: leaves the bone through a window of {:.1f} mm² at {}",
                                      report.cuts[i], window.area_mm2,
                                      place_words(window.at, landmarks)));
  for (const auto& [a, b] : report.crossings)
    sentences.push_back(fmt::format("{} and {} cross in the bone", report.cuts[a], report.cuts[b]));
  for (const DangerFinding& finding : report.dangers)
    if (finding.level != DangerLevel::clear) sentences.push_back(danger_text(finding));
  sentences.insert(sentences.end(), report.rooms.begin(), report.rooms.end());
  if (const std::string words = margin_words(report); !words.empty()) sentences.push_back(words);
  for (const CutPiece& piece : report.pieces) sentences.push_back(piece_words(piece));
  if (report.kerf_volume_mm3 > 0)
    sentences.push_back(fmt::format("the saw removes {:.1f} cm³", report.kerf_volume_mm3 / 1000));
  if (report.turned > 0)
    sentences.push_back(
        fmt::format("{} triangles of the cut faces face backward: the bone's surface crosses "
                    "itself there",
                    report.turned));
  sentences.insert(sentences.end(), report.notes.begin(), report.notes.end());
  return sentences;
}

namespace {

/// Whether the plan's cuts or grafts made a body.
bool is_made(const Operated& operated, const std::string& body) {
  return std::any_of(operated.cuts.begin(), operated.cuts.end(),
                     [&](const CutReport& cut) {
                       return std::any_of(cut.pieces.begin(), cut.pieces.end(),
                                          [&](const CutPiece& piece) {
                                            return piece.body == body && !piece.stays;
                                          });
                     }) ||
         std::any_of(operated.grafts.begin(), operated.grafts.end(), [&](const GraftLayout& graft) {
           const auto names = graft_bodies(graft.step);
           return std::find(names.begin(), names.end(), body) != names.end();
         });
}

/// The body's parts that the plan's cuts made or changed.
std::vector<const Part*> operated_parts(const Operated& operated, BodyId body) {
  std::vector<const Part*> parts;
  for (const Part& part : operated.patient.parts)
    if (part.body == body && operated.origin.contains(part.name)) parts.push_back(&part);
  return parts;
}

}  // namespace

std::vector<std::string> operated_segments(const Operated& operated) {
  std::vector<std::string> segments;
  for (int b = 0; b < operated.patient.bodies.size(); ++b) {
    const std::string& name = operated.patient.bodies[BodyId{b}].name;
    if (is_made(operated, name) && !operated_parts(operated, BodyId{b}).empty())
      segments.push_back(name);
  }
  return segments;
}

std::vector<BoneSummary> operated_bones(const Operated& operated) {
  const Case& patient = operated.patient;
  std::vector<BoneSummary> bones;
  for (int b = 0; b < patient.bodies.size(); ++b) {
    const Body& body = patient.bodies[BodyId{b}];
    BoneSummary bone{.name = body.name,
                     .parent = b == 0 ? "" : patient.bodies[body.parent].name,
                     .is_segment = is_made(operated, body.name)};
    for (const TrimReport& trim : operated.trims)
      if (trim.segment == body.name) bone.trimmed_mm3 += trim.removed_mm3();
    const auto parts = operated_parts(operated, BodyId{b});
    for (const Part* part : parts) {
      bone.volume_mm3 += signed_volume(part->mesh);
      bone.closed = bone.closed && inspect(part->mesh).closed();
    }
    if (!parts.empty()) bones.push_back(std::move(bone));
  }
  return bones;
}

std::string step_details(const PlanAction& action) {
  if (const auto* cut = std::get_if<CutStep>(&action)) return cut_details(*cut);
  if (const auto* note = std::get_if<NoteStep>(&action)) return note->text;
  if (std::holds_alternative<ResectStep>(action)) return "with its teeth";
  if (const auto* graft = std::get_if<GraftStep>(&action)) return graft_step_details(*graft);
  if (const auto* trim = std::get_if<TrimStep>(&action))
    return fmt::format("bone that overlaps {}{}", fmt::join(trim->of, ", "),
                       trim->below_margins ? "; below the least margins on request" : "");
  const auto& step = std::get<MoveStep>(action);
  const auto* move = std::get_if<ClinicalMove>(&step.move);
  return move ? fmt::format("{}; about {}", move_words(*move), point_name(*move, step.segment))
              : "as a pose";
}

std::string zones_text(const Plan& plan) {
  std::string text;
  for (const PlanZone& zone : plan.zones) {
    const DangerMargin margin = own_zone(zone).margin;
    text += fmt::format(
        "zone {}: {}, {}{}; cuts are warned of below {:g} mm, refused below {:g} mm\n", zone.name,
        zone_kind_name(zone.kind),
        zone.triangles.empty() ? fmt::format("a line of {} point{}", zone.points.size(),
                                             zone.points.size() == 1 ? "" : "s")
                               : fmt::format("a surface of {} triangles", zone.triangles.size()),
        zone.radius_mm > 0 ? fmt::format(", radius {:g} mm", zone.radius_mm) : "", margin.warn_mm,
        margin.stop_mm);
  }
  return text;
}

std::string steps_text(const Plan& plan) {
  std::string text;
  for (const PlanStep& step : plan.steps)
    text +=
        fmt::format("{:>3}  {}: {}\n", step.id, step_title(step.action), step_details(step.action));
  return text;
}

}  // namespace condyle
