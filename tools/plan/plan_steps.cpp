#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "engine/core/error.h"
#include "sim/plan/plan_file.h"
#include "tools/plan/plan_command.h"

namespace condyle {
namespace {

struct PlanStepOptions {
  std::filesystem::path file;
  int step = 0;
  int position = 0;  // in the order of the steps, from 1
  std::vector<std::string> words;
};

int run_plan_remove(const PlanStepOptions& options, const CommonOptions& common) {
  const Plan before = load_plan(options.file);
  const Plan plan = without_step(before, options.step);
  finish_edit(plan, options.file, "remove " + step_name(step_of(before, options.step)), common);
  for (const PlanStep& step : plan.steps) {
    if (std::holds_alternative<CutStep>(step.action)) continue;
    try {
      for (const std::string& segment : used_segments(step.action)) check_segment(plan, segment);
    } catch (const InputError& error) {
      print_plan_notes(common, {step_name(step) + ": " + error.what()});
    }
  }
  return 0;
}

int run_plan_reorder(const PlanStepOptions& options, const CommonOptions& common) {
  const Plan plan = with_reordered(load_plan(options.file), options.step,
                                   static_cast<std::size_t>(options.position - 1));
  finish_edit(plan, options.file, "reorder " + step_name(step_of(plan, options.step)), common);
  return 0;
}

int run_plan_note(const PlanStepOptions& options, const CommonOptions& common) {
  const NoteStep note{fmt::format("{}", fmt::join(options.words, " "))};
  finish_edit(with_step(load_plan(options.file), note), options.file, step_title(note), common);
  return 0;
}

}  // namespace

void add_plan_remove(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanStepOptions>();
  CLI::App& command = commands.add_below(
      plan, "remove", "Remove a step", "condyle plan remove plan.json 2",
      [options](const CommonOptions& common) { return run_plan_remove(*options, common); });
  add_plan_argument(command, options->file);
  add_step_argument(command, options->step);
}

void add_plan_reorder(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanStepOptions>();
  CLI::App& command = commands.add_below(
      plan, "reorder", "Put a step elsewhere in the order", "condyle plan reorder plan.json 3 1",
      [options](const CommonOptions& common) { return run_plan_reorder(*options, common); });
  add_plan_argument(command, options->file);
  add_step_argument(command, options->step);
  in_range(
      command.add_option("POSITION", options->position, "Its place in the list; 1 is the first")
          ->required(),
      1, 1000000);
}

void add_plan_note(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanStepOptions>();
  CLI::App& command = commands.add_below(
      plan, "note", "Add a note", "condyle plan note plan.json remove teeth 18 and 28 first",
      [options](const CommonOptions& common) { return run_plan_note(*options, common); });
  add_plan_argument(command, options->file);
  command.add_option("TEXT", options->words, "Its words")->required();
}

}  // namespace condyle
