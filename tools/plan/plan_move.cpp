#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>

#include "engine/core/error.h"
#include "sim/operation/segment_overlaps.h"
#include "sim/phantom/phantom.h"
#include "sim/plan/move_words.h"
#include "sim/plan/plan_file.h"
#include "tools/plan/plan_command.h"

namespace condyle {
namespace {

struct PlanMoveOptions {
  std::filesystem::path file;
  std::string segment;
  std::vector<std::string> words;
  std::string patient;
  bool slide = false, despite_collision = false;
};

Plan with_move(Plan plan, const MoveStep& move) {
  for (const PlanStep& step : plan.steps)
    if (const auto* known = std::get_if<MoveStep>(&step.action))
      if (known->segment == move.segment) return with_replaced(std::move(plan), step.id, move);
  return with_step(std::move(plan), move);
}

ClinicalMove scaled(ClinicalMove move, double fraction) {
  for (double* value : {&move.left_mm, &move.forward_mm, &move.up_mm, &move.roll_deg,
                        &move.pitch_deg, &move.yaw_deg})
    *value *= fraction;
  return move;
}

/// The case on which the move is checked; none where the plan's own is unknown.
std::optional<Case> case_of(const PlanMoveOptions& options, const Plan& plan,
                            const CommonOptions& common) {
  if (!options.patient.empty()) return open_planned(options.patient, plan, common);
  const std::string& name = plan.geometry.name;
  if (name == builtin_case_name || is_head_name(name)) {
    Case head = open_planned({}, plan, common);
    if (compare_geometry(plan.geometry, geometry_of(head)).match != CaseMatch::other_case)
      return head;
  }
  print_plan_notes(common, {"collisions of the move are not checked: give the case with --case"});
  return std::nullopt;
}

/// The move, or the free part of it where it slides. Reports the overlaps that it makes. throws:
/// InputError for a move that collides.
MoveStep checked_move(const Case& patient, const Plan& plan, MoveStep move,
                      const PlanMoveOptions& options, const CommonOptions& common) {
  Operated operated = apply_plan(patient, with_move(plan, move));
  auto overlaps = segment_overlaps(operated, move.segment);
  const auto collides = [](const SegmentOverlap& overlap) {
    return overlap.kind == SegmentOverlap::Kind::collision;
  };
  const Landmarks& landmarks = patient.landmarks;
  if (const auto hit = std::find_if(overlaps.begin(), overlaps.end(), collides);
      hit != overlaps.end() && !options.despite_collision) {
    const auto& whole = std::get<ClinicalMove>(move.move);
    const auto pose = [&](double fraction) {
      const MoveStep part{move.segment, scaled(whole, fraction)};
      return planned_pose(operated, plan, part);
    };
    const double fraction = free_fraction(operated, move.segment, pose);
    const ClinicalMove free = scaled(whole, fraction);
    const std::string what =
        fmt::format("{}; {:.0f} % of the move is free: {}", overlap_text(*hit, landmarks),
                    100 * fraction, fraction > 0 ? move_words(free) : "nothing");
    if (!options.slide)
      throw InputError(fmt::format(
          "move {} is not added: {}. --slide adds the free part, --despite-collision the whole "
          "move",
          move.segment, what));
    print_plan_notes(common, {what + "; this part is added"});
    move.move = free;
    operated = apply_plan(patient, with_move(plan, move));
    overlaps = segment_overlaps(operated, move.segment);
  }
  std::vector<std::string> texts;
  for (const SegmentOverlap& overlap : overlaps) texts.push_back(overlap_text(overlap, landmarks));
  print_plan_notes(common, texts);
  return move;
}

int run_plan_move(const PlanMoveOptions& options, const CommonOptions& common) {
  Plan plan = load_plan(options.file);
  check_segment(plan, options.segment);
  const WrittenMove written = parse_move_words(options.words);
  const Landmarks& landmarks = plan.geometry.landmarks;
  MoveStep move{options.segment, completed_move(written, options.segment, landmarks,
                                                clinical_frame(landmarks, plan.reference))};
  if (const auto patient = case_of(options, plan, common))
    move = checked_move(*patient, plan, std::move(move), options, common);
  plan = with_move(std::move(plan), move);
  finish_edit(plan, options.file, step_title(move), common);
  return 0;
}

}  // namespace

void add_plan_move(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanMoveOptions>();
  CLI::App& command = commands.add_below(
      plan, "move", "Move a segment, from where it lay before the operation",
      "condyle plan move plan.json maxilla forward 4 up 2 pns up 4",
      [options](const CommonOptions& common) { return run_plan_move(*options, common); });
  add_plan_argument(command, options->file);
  command.add_option("SEGMENT", options->segment, "Its name")->required();
  command
      .add_option("WORDS", options->words,
                  "The move: forward, back, left, right, up, down with mm; pitch, roll, yaw with "
                  "degrees; about POINT; POINT up MM in place of a pitch")
      ->required();
  add_plan_case(command, options->patient);
  auto* slide = command.add_flag("--slide", options->slide,
                                 "Of a move that collides add the largest part that is free");
  command
      .add_flag("--despite-collision", options->despite_collision,
                "Add the move though it collides")
      ->excludes(slide);
}

}  // namespace condyle
