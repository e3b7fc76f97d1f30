#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "engine/core/error.h"
#include "sim/operation/move_collision.h"
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

/// The move, or the free part of it where it slides. Reports the overlaps that it makes. throws:
/// InputError for a move that collides.
MoveStep checked_move(const Case& patient, const Plan& plan, MoveStep move,
                      const PlanMoveOptions& options, const CommonOptions& common) {
  Operated operated = apply_plan(patient, with_move(plan, move));
  const auto collision =
      options.despite_collision ? std::nullopt : move_collision(operated, plan, move);
  if (collision) {
    if (!options.slide)
      throw InputError(fmt::format(
          "move {} is not added: {}. --slide adds the free part, --despite-collision the whole "
          "move",
          move.segment, collision->words));
    if (collision->free_fraction <= 0)
      throw InputError(fmt::format("move {} is not added: {}, so there is no part to slide",
                                   move.segment, collision->words));
    print_plan_notes(common, {collision->words + "; this part is added"});
    move.move = collision->free;
    operated = apply_plan(patient, with_move(plan, move));
  }
  std::vector<std::string> texts;
  bool is_trimmed = false;
  for (const SegmentOverlap& overlap : segment_overlaps(operated, move.segment)) {
    texts.push_back(overlap_text(overlap, patient.landmarks));
    is_trimmed = is_trimmed || overlap.kind == SegmentOverlap::Kind::trimmed;
  }
  if (is_trimmed) texts.push_back("condyle plan trim removes the overlap of one of two segments");
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
  if (const auto patient = case_of_plan(options.patient, plan, common))
    move = checked_move(*patient, plan, std::move(move), options, common);
  else
    print_plan_notes(common, {"collisions of the move are not checked: give the case with --case"});
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
