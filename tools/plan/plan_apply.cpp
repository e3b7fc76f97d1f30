#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <set>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/case/case_io.h"
#include "sim/operation/cut_text.h"
#include "sim/plan/plan_file.h"
#include "tools/plan/plan_command.h"
#include "tools/plan/plan_report.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

struct PlanApplyOptions {
  fs::path file;
  std::string patient;
  fs::path out;
};

int run_plan_show(const PlanApplyOptions& options, const CommonOptions& common) {
  const Plan plan = load_plan(options.file);
  if (options.patient.empty()) {
    fmt::print("{}", common.json
                         ? plan_json(plan)
                         : fmt::format("{}, a plan for {}\n{}{}", plan.name, plan.geometry.name,
                                       steps_text(plan), zones_text(plan)));
    return 0;
  }
  const Operated operated = apply_plan(open_planned(options.patient, plan, common), plan);
  if (common.json)
    fmt::print("{}\n", plan_report_json(plan, operated)
                           .dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  else
    fmt::print("{}", plan_report_text(plan, operated));
  print_plan_notes(common, operated.notes);
  print_plan_notes(common, operated.problems);
  return 0;
}

/// Files in `segments` that an earlier apply wrote, by its report: "segments/chin.ply".
std::set<std::string> earlier_files(const fs::path& report) {
  std::set<std::string> files;
  try {
    const auto json = nlohmann::json::parse(read_file(report));
    if (!json.at("plan").is_string()) return files;
    // Reports had no list of files at first.
    for (const auto& segment : json.at("segments"))
      files.insert("segments/" + segment.at("name").get<std::string>() + ".ply");
    if (json.contains("files"))
      for (const auto& file : json["files"]) files.insert(file.get<std::string>());
  } catch (const InputError&) {  // there is none
  } catch (const nlohmann::json::exception&) {
    files.clear();  // of another command
  }
  return files;
}

/// Removes what an earlier apply wrote into `segments` and this one did not.
void remove_earlier(const std::set<std::string>& earlier, const std::set<std::string>& written,
                    const fs::path& out) {
  for (const std::string& name : earlier) {
    const fs::path file = out / name;
    std::error_code error;
    if (written.contains(name) || file.parent_path() != out / "segments" ||
        file.extension() != ".ply" || !fs::is_regular_file(fs::symlink_status(file, error)))
      continue;
    fs::remove(file, error);
    if (error) throw MachineError(file.string() + ": cannot be removed: " + error.message());
  }
}

int run_plan_apply(const PlanApplyOptions& options, const CommonOptions& common) {
  const Plan plan = load_plan(options.file);
  const Operated operated = apply_plan(open_planned(options.patient, plan, common), plan);
  if (!operated.problems.empty())
    throw InputError(
        fmt::format("{}: {}", options.file.string(), fmt::join(operated.problems, "; ")));
  const Case after = operated_case(operated);
  make_folder(options.out / "segments");
  save_case(after, options.out / "case");
  std::set<std::string> written;
  for (const Part& part : after.parts)
    if (is_piece(part.role) && operated.origin.contains(part.name)) {
      const std::string file = "segments/" + part.name + ".ply";
      write_ply(part.mesh, options.out / file);
      written.insert(file);
    }
  // Before the new report replaces the earlier one, which names them.
  remove_earlier(earlier_files(options.out / "report.json"), written, options.out);
  auto json = plan_report_json(plan, operated);
  json["files"] = written;
  const std::string report =
      json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  write_file(options.out / "report.json", report);
  if (common.json) fmt::print("{}", report);
  print_plan_notes(common, operated.notes);
  if (common.prints_summary())
    fmt::print(stderr,
               "{}\n{}: segments as PLY, the patient after the operation in case, and "
               "report.json\n",
               plan_report_text(plan, operated), options.out.string());
  return 0;
}

}  // namespace

void add_plan_show(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanApplyOptions>();
  CLI::App& command = commands.add_below(
      plan, "show", "Print a plan: steps, and with the case its cuts and tables",
      "condyle plan show plan.json --case mycase",
      [options](const CommonOptions& common) { return run_plan_show(*options, common); });
  add_plan_argument(command, options->file);
  add_plan_case(command, options->patient, "none, the steps are printed alone");
}

void add_plan_apply(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanApplyOptions>();
  CLI::App& command = commands.add_below(
      plan, "apply", "Write the segments and the patient after the operation",
      "condyle plan apply plan.json --case mycase --out out/operated",
      [options](const CommonOptions& common) { return run_plan_apply(*options, common); });
  add_plan_argument(command, options->file);
  add_plan_case(command, options->patient);
  command.add_option("--out", options->out, "Folder for segments, case and report.json")
      ->type_name("FOLDER")
      ->required();
}

}  // namespace condyle
