#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/text_list.h"
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
  std::string osteotomy, target, pieces;
  std::vector<std::string> settings;  // NAME=VALUE
  bool below_margins = false;
  std::optional<double> kerf_mm;  // not given: that of the osteotomy
};

std::map<std::string, double> parse_settings(const std::vector<std::string>& settings) {
  std::map<std::string, double> parameters;
  for (const std::string& setting : settings) {
    const auto equals = setting.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw InputError("--set " + setting + ": expected NAME=VALUE, e.g. height_mm=6");
    const std::string name = setting.substr(0, equals);
    if (!parameters.emplace(name, parse_number(setting.substr(equals + 1), "--set " + name)).second)
      throw InputError("--set " + name + ": is given twice");
  }
  return parameters;
}

/// Refuses a cut that comes nearer to a root, canal or foramen than any surgeon would.
void refuse_dangerous(const CutReport& report) {
  std::vector<std::string> dangers;
  for (const DangerFinding& finding : report.dangers)
    if (finding.level == DangerLevel::stop) dangers.push_back(danger_text(finding));
  if (!dangers.empty())
    throw InputError(
        fmt::format("{} is not added: {}. Change its parameters with --set, or add it all the same "
                    "with --below-margins",
                    report.title, fmt::join(dangers, "; ")));
}

int run_plan_cut(const PlanCutOptions& options, const CommonOptions& common) {
  const Plan plan = load_plan(options.file);
  CutStep step;
  step.osteotomy = options.osteotomy;
  step.target = options.target;
  step.parameters = parse_settings(options.settings);
  // Refuses an unknown name before the patient is read.
  step.kerf_mm = options.kerf_mm.value_or(default_kerf_mm(step.osteotomy));
  const Case patient = open_planned(options.patient, common);
  if (!options.pieces.empty())
    step.pieces = split_list(options.pieces);
  else
    for (const SegmentRule& rule :
         place_osteotomy(apply_plan(patient, plan).patient, step).segments)
      step.pieces.push_back(rule.name);
  const Plan edited = with_step(plan, step);
  const Operated operated = apply_plan(patient, edited);
  if (!options.below_margins && !operated.cuts.empty() &&
      operated.cuts.back().step == edited.steps.back().id)
    refuse_dangerous(operated.cuts.back());
  finish_edit(edited, options.file, common);
  print_plan_notes(common, operated.notes);
  if (common.prints_summary())
    fmt::print(stderr, "{}", cut_report_text(operated, edited.steps.back().id));
  print_plan_notes(common, operated.problems);
  return 0;
}

}  // namespace

void add_plan_cut(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanCutOptions>();
  CLI::App& command = commands.add_below(
      plan, "cut", "Add an osteotomy", "condyle plan cut plan.json le_fort_1 --case mycase",
      [options](const CommonOptions& common) { return run_plan_cut(*options, common); });
  add_edited_plan(command, options->file);
  command.add_option("OSTEOTOMY", options->osteotomy, "Its name, such as le_fort_1")->required();
  add_plan_case(command, options->patient);
  command.add_option("--set", options->settings, "A parameter of the osteotomy; may be repeated")
      ->type_name("NAME=VALUE");
  in_range(
      command.add_option(
          "--kerf", options->kerf_mm,
          "Thickness of the saw cut, mm; default 1.2 for the vault, 2 for barrel staves, else 0"),
      0, max_kerf_mm);
  command
      .add_option("--target", options->target,
                  "Body or segment to cut; default that of the osteotomy")
      ->type_name("NAME");
  command.add_flag("--below-margins", options->below_margins,
                   "Add the cut though it lies too near to a root, canal or foramen");
  command.add_option("--pieces", options->pieces, "Names of the segments, in its order")
      ->type_name("A,B,...");
}

}  // namespace condyle
