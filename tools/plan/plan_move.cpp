#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "sim/plan/move_words.h"
#include "sim/plan/plan_file.h"
#include "tools/plan/plan_command.h"

namespace condyle {
namespace {

struct PlanMoveOptions {
  std::filesystem::path file;
  std::string segment;
  std::vector<std::string> words;
};

int run_plan_move(const PlanMoveOptions& options, const CommonOptions& common) {
  Plan plan = load_plan(options.file);
  check_segment(plan, options.segment);
  const WrittenMove written = parse_move_words(options.words);
  const Landmarks& landmarks = plan.geometry.landmarks;
  const MoveStep move{options.segment, completed_move(written, options.segment, landmarks,
                                                      clinical_frame(landmarks, plan.reference))};
  std::optional<int> earlier;
  for (const PlanStep& step : plan.steps)
    if (const auto* known = std::get_if<MoveStep>(&step.action))
      if (known->segment == options.segment) earlier = step.id;
  plan =
      earlier ? with_replaced(std::move(plan), *earlier, move) : with_step(std::move(plan), move);
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
}

}  // namespace condyle
