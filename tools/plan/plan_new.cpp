#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "tools/plan/plan_command.h"

namespace condyle {
namespace {

struct PlanNewOptions {
  std::string patient;  // case folder; "built-in" or empty: the built-in patient
  std::filesystem::path out;
  std::string name;
  bool natural_head = false;
};

int run_plan_new(const PlanNewOptions& options, const CommonOptions& common) {
  const Case patient = open_planned(options.patient, {}, common);
  Plan plan;
  plan.name = !options.name.empty() ? options.name : options.out.stem().string();
  plan.geometry = geometry_of(patient);
  if (options.natural_head) plan.reference.horizontal = Horizontal::natural_head_position;
  try {
    print_plan_notes(common, clinical_frame(patient.landmarks, plan.reference).notes);
  } catch (const InputError& error) {
    print_plan_notes(
        common,
        {fmt::format(
            "moves in words are not possible: {}. --natural-head takes the case's axes instead",
            error.what())});
  }
  if (options.out.has_parent_path()) make_folder(options.out.parent_path());
  finish_edit(plan, options.out, "new plan", common);
  return 0;
}

}  // namespace

void add_plan_new(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanNewOptions>();
  CLI::App& command = commands.add_below(
      plan, "new", "Begin a plan for a case", "condyle plan new mycase --out plan.json",
      [options](const CommonOptions& common) { return run_plan_new(*options, common); });
  command.add_option("CASE", options->patient,
                     "Folder with case.json (default: the built-in patient)");
  command.add_option("--out", options->out, "File of the new plan")->type_name("FILE")->required();
  command.add_option("--name", options->name, "Name of the plan; default that of the file")
      ->type_name("TEXT");
  command.add_flag("--natural-head", options->natural_head,
                   "Moves count in natural head position, with the case's z axis up, not by the "
                   "Frankfort plane");
}

}  // namespace condyle
