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
};

int run_plan_remove(const PlanStepOptions& options, const CommonOptions& common) {
  const Plan plan = without_step(load_plan(options.file), options.step);
  finish_edit(plan, options.file, common);
  for (const PlanStep& step : plan.steps) {
    const auto* move = std::get_if<MoveStep>(&step.action);
    if (!move) continue;
    try {
      check_segment(plan, move->segment);
    } catch (const InputError& error) {
      print_plan_notes(common, {step_name(step) + ": " + error.what()});
    }
  }
  return 0;
}

}  // namespace

void add_plan_remove(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanStepOptions>();
  CLI::App& command = commands.add_below(
      plan, "remove", "Remove a step", "condyle plan remove plan.json 2",
      [options](const CommonOptions& common) { return run_plan_remove(*options, common); });
  add_edited_plan(command, options->file);
  in_range(command.add_option("STEP", options->step, "Its number")->required(), 1, 1000000);
}

}  // namespace condyle
