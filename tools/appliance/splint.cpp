#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

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
  check_voxel(settings.voxel_mm);
  check_files(options.files);
  const Plan plan = load_plan(options.plan);
  const Operated operated = apply_plan(open_planned(options.patient, plan, common), plan);
  ProgressBar bar(common);
  const Splint splint = make_splint(splint_arches(operated, kind, first), settings, bar.callback());
  bar.clear();
  write_appliance(splint.mesh, options.files);
  print_plan_notes(common, splint.notes);
  const std::string title = options.kind + " splint";
  if (!options.files.picture.empty())
    write_splint_picture(splint, patient_at_stage(operated, kind, first),
                         {title + " of " + plan.name, splint_text(splint, settings)},
                         options.files.picture);
  if (common.json) {
    nlohmann::ordered_json json{{"kind", options.kind}};
    if (kind == SplintKind::intermediate) json["first"] = options.first;
    json["file"] = options.files.out.string();
    json.update(splint_json(splint, settings));
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  }
  if (common.prints_summary())
    fmt::print(stderr, "{}: {}\n{}", options.files.out.string(), title,
               splint_text(splint, settings));
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
  begin_group(command, "Shape");
  SplintSettings& settings = options->settings;
  const auto add = [&](const char* name, double& value, const char* what, double low, double high) {
    in_range(command.add_option(name, value, fmt::format("{}; default {} mm", what, value)), low,
             high);
  };
  add("--thickness", settings.thickness_mm, "Least thickness between cusps", 0.5, 10);
  add("--depth", settings.depth_mm, "Depth of the prints from the tips of the teeth", 0.5, 6);
  add("--wall", settings.wall_mm, "Width beside the teeth", 1.2, 6);
  add("--gap", settings.gap_mm, "Gap between teeth and print", 0, 0.5);
  add("--grip", settings.grip_mm, "Deepest undercut that the print holds", 0, 1);
  add("--voxel", settings.voxel_mm, "Spacing of the samples", least_voxel_mm, largest_voxel_mm);
  options->has_opening = in_range(
      command.add_option("--opening", options->opening_mm,
                         "Opening of the bite at the incisors by the hinge, mm; default what the "
                         "thickness needs"),
      -15, 25);
}

}  // namespace condyle
