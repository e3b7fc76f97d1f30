#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/text_list.h"
#include "sim/operation/edit_cut.h"
#include "sim/osteotomy/osteotomy.h"
#include "sim/plan/plan_file.h"
#include "tools/common.h"
#include "tools/plan/plan_command.h"
#include "tools/plan/plan_report.h"

namespace condyle {
namespace {

struct PlanCutOptions {
  std::filesystem::path file;  // of the plan
  std::string patient;
  std::string osteotomy;
  int step = 0;                       // that is changed
  std::vector<std::string> settings;  // NAME=VALUE
  std::optional<double> kerf_mm;      // not given: that of the osteotomy, or as it is
  std::optional<std::string> target;
  std::string pieces;
  bool below_margins = false;
};

/// Values by name; of a cut that is changed, "default" has none.
std::map<std::string, std::optional<double>> parse_settings(const PlanCutOptions& options) {
  std::map<std::string, std::optional<double>> values;
  for (const std::string& setting : options.settings) {
    const auto equals = setting.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw InputError("--set " + setting + ": expected NAME=VALUE, e.g. height_mm=6");
    const std::string name = setting.substr(0, equals), text = setting.substr(equals + 1);
    std::optional<double> value;
    if (text != "default") value = parse_number(text, "--set " + name);
    if (!values.emplace(name, value).second) throw InputError("--set " + name + ": is given twice");
  }
  return values;
}

/// The step with the options that are given; other values stay.
CutStep changed_cut(CutStep step, const PlanCutOptions& options) {
  for (const auto& [name, value] : parse_settings(options)) {
    step.parameters.erase(name);
    if (value) step.parameters[name] = *value;
  }
  step.kerf_mm = options.kerf_mm.value_or(step.kerf_mm);
  step.target = options.target.value_or(step.target);
  if (!options.pieces.empty()) step.pieces = split_list(options.pieces);
  step.below_margins = options.below_margins;
  return step;
}

/// Refuses a cut that comes nearer to a root, canal or foramen than any surgeon would.
void refuse_dangerous(const Operated& operated, const PlanStep& step, const char* verb) {
  if (const std::string dangers = dangers_below_margins(operated, step.id); !dangers.empty())
    throw InputError(
        fmt::format("{} is not {}ed: {}. Change its parameters with --set, or {} it all the same "
                    "with --below-margins",
                    step_title(step.action), verb, dangers, verb));
}

/// Saves the plan unless the step's cut is dangerous, and prints what it cuts. `verb`: "add".
void finish_cut(const Plan& plan, const PlanStep& step, const Case& patient, const char* verb,
                const PlanCutOptions& options, const CommonOptions& common) {
  const Operated operated = apply_plan(patient, plan);
  std::vector<std::string> notes = operated.notes;
  refuse_dangerous(operated, step, verb);
  for (const CutReport& cut : operated.cuts) {
    if (cut.is_dangerous() && !cut.below_margins)
      notes.push_back(
          fmt::format("step {} ({}) lies below the least margins", cut.step, cut.title));
  }
  const std::string edit = verb == std::string("add") ? step_title(step.action)
                                                      : fmt::format("{} {}", verb, step_name(step));
  finish_edit(plan, options.file, edit, common);
  print_plan_notes(common, notes);
  if (common.prints_summary()) fmt::print(stderr, "{}", cut_report_text(operated, step.id));
  print_plan_notes(common, operated.problems);
}

int run_plan_cut(const PlanCutOptions& options, const CommonOptions& common) {
  const Plan plan = load_plan(options.file);
  // Refuses an unknown name before the patient is read.
  CutStep step = changed_cut(
      {.osteotomy = options.osteotomy, .kerf_mm = default_kerf_mm(options.osteotomy)}, options);
  const Case patient = open_planned(options.patient, plan, common);
  if (options.pieces.empty()) step.pieces = segment_names(apply_plan(patient, plan).patient, step);
  const Plan edited = with_step(plan, step);
  finish_cut(edited, edited.steps.back(), patient, "add", options, common);
  return 0;
}

int run_plan_edit(const PlanCutOptions& options, const CommonOptions& common) {
  if (options.settings.empty() && !options.kerf_mm && !options.target && options.pieces.empty() &&
      !options.below_margins)
    throw InputError("give what is changed: --set, --kerf, --target, --pieces or --below-margins");
  const Plan plan = load_plan(options.file);
  const PlanStep& known = step_of(plan, options.step);
  const auto* before = std::get_if<CutStep>(&known.action);
  if (!before)
    throw InputError(fmt::format("{} is no cut; {}", step_name(known),
                                 std::holds_alternative<MoveStep>(known.action)
                                     ? "condyle plan move replaces the move of a segment"
                                 : std::holds_alternative<TrimStep>(known.action)
                                     ? "condyle plan trim replaces the trim of a segment"
                                 : std::holds_alternative<GraftStep>(known.action)
                                     ? "condyle plan graft changes a graft of the same name"
                                     : "remove it, and add another"));
  CutStep step = changed_cut(*before, options);
  const Case patient = open_planned(options.patient, plan, common);
  const Plan edited =
      with_changed_cut(patient, plan, options.step, std::move(step), !options.pieces.empty());
  finish_cut(edited, step_of(edited, options.step), patient, "edit", options, common);
  return 0;
}

void add_cut_options(CLI::App& command, PlanCutOptions& options, const char* kerf,
                     const char* target) {
  command.add_option("--set", options.settings, "A parameter of the osteotomy; may be repeated")
      ->type_name("NAME=VALUE");
  in_range(command.add_option("--kerf", options.kerf_mm,
                              fmt::format("Thickness of the saw cut, mm; default {}", kerf)),
           0, max_kerf_mm);
  command
      .add_option("--target", options.target,
                  fmt::format("Body or segment to cut; default {}", target))
      ->type_name("NAME");
  command.add_flag("--below-margins", options.below_margins,
                   "Allow a cut that lies too near to a root, canal or foramen");
  command.add_option("--pieces", options.pieces, "Names of the segments, in its order")
      ->type_name("A,B,...");
}

}  // namespace

void add_plan_cut(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanCutOptions>();
  CLI::App& command = commands.add_below(
      plan, "cut", "Add an osteotomy", "condyle plan cut plan.json le_fort_1 --case mycase",
      [options](const CommonOptions& common) { return run_plan_cut(*options, common); });
  add_plan_argument(command, options->file);
  command.add_option("OSTEOTOMY", options->osteotomy, "Its name, such as le_fort_1")->required();
  add_plan_case(command, options->patient);
  add_cut_options(command, *options, "1.2 for the vault, 2 for barrel staves, else 0",
                  "that of the osteotomy");
}

void add_plan_edit(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanCutOptions>();
  CLI::App& command = commands.add_below(
      plan, "edit", "Change a cut where it stands; the steps after it stay",
      "condyle plan edit plan.json 1 --set height_mm=6 --case mycase",
      [options](const CommonOptions& common) { return run_plan_edit(*options, common); });
  add_plan_argument(command, options->file);
  add_step_argument(command, options->step);
  add_plan_case(command, options->patient);
  add_cut_options(command, *options, "as it is", "as it is");
}

}  // namespace condyle
