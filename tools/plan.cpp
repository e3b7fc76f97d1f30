#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/similar_word.h"
#include "engine/core/text_list.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/case/case_io.h"
#include "sim/operation/cut_text.h"
#include "sim/osteotomy/osteotomy.h"
#include "sim/plan/move_words.h"
#include "sim/plan/plan_file.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/plan_compare.h"
#include "tools/plan_report.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct PlanOptions {
  fs::path file;        // of the plan
  std::string patient;  // case folder; "built-in" or empty: the built-in patient
  fs::path out;
  std::string name;
  bool natural_head = false;
  std::string osteotomy, target, pieces;
  std::vector<std::string> settings;  // NAME=VALUE
  bool below_margins = false;
  std::optional<double> kerf_mm;  // not given: that of the osteotomy
  std::string segment;
  std::vector<std::string> words;
  int step = 0;
};

Case open_planned(const std::string& patient, const CommonOptions& common) {
  ProgressBar bar(common);
  Case opened = open_patient(patient, common, bar);
  bar.clear();
  return opened;
}

void print_plan_notes(const CommonOptions& common, const std::vector<std::string>& notes) {
  if (!common.prints_summary()) return;
  for (const auto& note : notes) fmt::print(stderr, "note: {}\n", note);
}

/// Saves an edited plan, and prints its steps, or all of it as JSON.
void finish_edit(const Plan& plan, const fs::path& file, const CommonOptions& common) {
  save_plan(plan, file);
  if (common.json) fmt::print("{}", plan_json(plan));
  if (common.prints_summary())
    fmt::print(stderr, "{}: {}, {} step{}\n{}", file.string(), plan.name, plan.steps.size(),
               plan.steps.size() == 1 ? "" : "s", steps_text(plan));
}

int run_new(const PlanOptions& options, const CommonOptions& common) {
  const Case patient = open_planned(options.patient, common);
  Plan plan;
  plan.name = !options.name.empty() ? options.name : options.out.stem().string();
  plan.geometry = geometry_of(patient);
  if (options.natural_head) plan.reference.horizontal = Horizontal::natural_head_position;
  try {
    print_plan_notes(common, clinical_frame(patient.landmarks, plan.reference).notes);
  } catch (const InputError& error) {
    print_plan_notes(common, {fmt::format("moves in words are not possible: {}", error.what())});
  }
  if (options.out.has_parent_path()) make_folder(options.out.parent_path());
  finish_edit(plan, options.out, common);
  return 0;
}

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

int run_cut(const PlanOptions& options, const CommonOptions& common) {
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

/// Refuses a segment that no step makes. Pieces that were imported are known by their names.
void check_segment(const Plan& plan, const std::string& segment) {
  std::vector<std::string> known = {"mandible"};
  for (const PlanStep& step : plan.steps)
    if (const auto* cut = std::get_if<CutStep>(&step.action))
      known.insert(known.end(), cut->pieces.begin(), cut->pieces.end());
  for (const PartGeometry& part : plan.geometry.parts)
    if (part.name.starts_with("segment") || part.name.starts_with("transplant"))
      known.push_back(part.name);
  if (std::find(known.begin(), known.end(), segment) != known.end()) return;
  throw InputError(fmt::format("no step of the plan makes \"{}\"{}; known are {}", segment,
                               suggestion(segment, known), fmt::join(known, ", ")));
}

int run_move(const PlanOptions& options, const CommonOptions& common) {
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
  finish_edit(plan, options.file, common);
  return 0;
}

int run_remove(const PlanOptions& options, const CommonOptions& common) {
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

int run_show(const PlanOptions& options, const CommonOptions& common) {
  const Plan plan = load_plan(options.file);
  if (options.patient.empty()) {
    fmt::print("{}", common.json ? plan_json(plan)
                                 : fmt::format("{}, a plan for {}\n{}", plan.name,
                                               plan.geometry.name, steps_text(plan)));
    return 0;
  }
  const Operated operated = apply_plan(open_planned(options.patient, common), plan);
  if (common.json)
    fmt::print(
        "{}\n",
        plan_report_json(plan, operated).dump(2, ' ', false, Json::error_handler_t::replace));
  else
    fmt::print("{}", plan_report_text(plan, operated));
  print_plan_notes(common, operated.notes);
  print_plan_notes(common, operated.problems);
  return 0;
}

int run_apply(const PlanOptions& options, const CommonOptions& common) {
  const Plan plan = load_plan(options.file);
  const Operated operated = apply_plan(open_planned(options.patient, common), plan);
  if (!operated.problems.empty())
    throw InputError(
        fmt::format("{}: {}", options.file.string(), fmt::join(operated.problems, "; ")));
  const Case after = operated_case(operated);
  make_folder(options.out / "segments");
  save_case(after, options.out / "case");
  for (const Part& part : after.parts)
    if (part.role == Role::segment && operated.origin.contains(part.name))
      write_ply(part.mesh, options.out / "segments" / (part.name + ".ply"));
  const std::string report =
      plan_report_json(plan, operated).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
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

using SharedOptions = std::shared_ptr<PlanOptions>;

void add_file(CLI::App& command, const SharedOptions& options) {
  command.add_option("PLAN", options->file, "File of the plan")->required();
}
void add_case(CLI::App& command, const SharedOptions& options, const char* what) {
  command.add_option("--case", options->patient, what)->type_name("FOLDER|built-in");
}
constexpr const char* default_case = "The case of the plan (default: the built-in patient)";

void add_new(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanOptions>();
  CLI::App& command = commands.add_below(
      plan, "new", "Begin a plan for a case", "condyle plan new mycase --out plan.json",
      [options](const CommonOptions& common) { return run_new(*options, common); });
  command.add_option("CASE", options->patient,
                     "Folder with case.json (default: the built-in patient)");
  command.add_option("--out", options->out, "File of the new plan")->type_name("FILE")->required();
  command.add_option("--name", options->name, "Name of the plan; default that of the file")
      ->type_name("TEXT");
  command.add_flag("--natural-head", options->natural_head,
                   "Moves count in natural head position, with the case's z axis up, not by the "
                   "Frankfort plane");
}

void add_cut(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanOptions>();
  CLI::App& command = commands.add_below(
      plan, "cut", "Add an osteotomy", "condyle plan cut plan.json le_fort_1 --case mycase",
      [options](const CommonOptions& common) { return run_cut(*options, common); });
  add_file(command, options);
  command.add_option("OSTEOTOMY", options->osteotomy, "Its name, such as le_fort_1")->required();
  add_case(command, options, default_case);
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

void add_move(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanOptions>();
  CLI::App& command = commands.add_below(
      plan, "move", "Move a segment, from where it lay before the operation",
      "condyle plan move plan.json maxilla forward 4 up 2 pns up 4",
      [options](const CommonOptions& common) { return run_move(*options, common); });
  add_file(command, options);
  command.add_option("SEGMENT", options->segment, "Its name")->required();
  command
      .add_option("WORDS", options->words,
                  "The move: forward, back, left, right, up, down with mm; pitch, roll, yaw with "
                  "degrees; about POINT; POINT up MM in place of a pitch")
      ->required();
}

void add_show(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanOptions>();
  CLI::App& command = commands.add_below(
      plan, "show", "Print a plan: steps, and with the case its cuts and tables",
      "condyle plan show plan.json --case mycase",
      [options](const CommonOptions& common) { return run_show(*options, common); });
  add_file(command, options);
  add_case(command, options, "The case of the plan; default: none, the steps are printed alone");
}

void add_apply(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanOptions>();
  CLI::App& command = commands.add_below(
      plan, "apply", "Write the segments and the patient after the operation",
      "condyle plan apply plan.json --case mycase --out out/operated",
      [options](const CommonOptions& common) { return run_apply(*options, common); });
  add_file(command, options);
  add_case(command, options, default_case);
  command.add_option("--out", options->out, "Folder for segments, case and report.json")
      ->type_name("FOLDER")
      ->required();
}

void add_remove(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanOptions>();
  CLI::App& command = commands.add_below(
      plan, "remove", "Remove a step", "condyle plan remove plan.json 2",
      [options](const CommonOptions& common) { return run_remove(*options, common); });
  add_file(command, options);
  in_range(command.add_option("STEP", options->step, "Its number")->required(), 1, 1000000);
}

}  // namespace

void add_plan(Commands& commands) {
  CLI::App& plan = commands.add_parent("plan", "Plan an operation: cuts and moves of segments",
                                       "condyle plan new --out plan.json\n"
                                       "  condyle plan cut plan.json le_fort_1\n"
                                       "  condyle plan move plan.json maxilla forward 4 up 2");
  for (const auto add :
       {add_new, add_cut, add_move, add_show, add_apply, add_remove, add_plan_compare})
    add(commands, plan);
}

}  // namespace condyle
