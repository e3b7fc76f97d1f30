#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "sim/appliance/appliance_text.h"
#include "sim/appliance/plan_arches.h"
#include "sim/plan/plan_file.h"
#include "tools/appliance/appliance_output.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/plan/plan_command.h"

namespace condyle {
namespace {

struct SplintOptions {
  std::filesystem::path plan;
  std::string patient, kind = "final", first = "upper";
  double opening_mm = 0;
  const CLI::Option* has_opening = nullptr;
  SplintSettings settings;
  ApplianceFiles files;
};

const Choices<SplintKind> kinds = {{"intermediate", SplintKind::intermediate},
                                   {"final", SplintKind::final_bite}};
const Choices<FirstJaw> first_jaws = {{"upper", FirstJaw::upper}, {"lower", FirstJaw::lower}};

int run_splint(const SplintOptions& options, const CommonOptions& common) {
  const SplintKind kind = chosen(kinds, "--kind", options.kind);
  const FirstJaw first = chosen(first_jaws, "--first", options.first);
  SplintSettings settings = options.settings;
  settings.threads = common.threads;
  if (options.has_opening->count() > 0) settings.opening_mm = options.opening_mm;
  check_files(options.files);
  const Plan plan = load_plan(options.plan);
  const Operated operated = apply_plan(open_planned(options.patient, plan, common), plan);
  ProgressBar bar(common);
  const Splint splint = make_splint(splint_arches(operated, kind, first), settings, bar.callback());
  bar.clear();
  ApplianceReport report{options.kind + " splint",      plan.name,
                         splint_text(splint, settings), splint.notes,
                         {{"kind", options.kind}},      {}};
  if (kind == SplintKind::intermediate) report.json["first"] = options.first;
  report.json["file"] = options.files.out.string();
  report.json.update(splint_json(splint, settings));
  report.draw = [&](const PictureText& text, const std::filesystem::path& file) {
    write_splint_picture(splint, patient_at_stage(operated, kind, first), text, file);
  };
  finish_appliance(splint.mesh, report, options.files, common);
  return 0;
}

}  // namespace

void add_splint(Commands& commands) {
  const auto options = std::make_shared<SplintOptions>();
  CLI::App& command =
      commands.add("splint", "Make an occlusal splint for the planned positions of the jaws",
                   "condyle splint plan.json --kind intermediate --out splint.stl",
                   [options](const CommonOptions& common) { return run_splint(*options, common); });
  add_plan_argument(command, options->plan);
  add_plan_case(command, options->patient);
  command
      .add_option("--kind", options->kind,
                  "final: both jaws moved; intermediate: one moved, the other at rest")
      ->type_name(words_of(kinds));
  command.add_option("--first", options->first, "The jaw that an intermediate splint moves first")
      ->type_name(words_of(first_jaws));
  add_appliance_files(command, options->files);
  add_lengths(command, options->settings, splint_lengths);
  options->has_opening = in_range(
      command.add_option("--opening", options->opening_mm,
                         "Opening of the bite at the incisors by the hinge, mm; default what the "
                         "thickness needs"),
      -15, 25);
}

}  // namespace condyle
