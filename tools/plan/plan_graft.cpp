#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/similar_word.h"
#include "sim/graft/donor.h"
#include "sim/plan/plan_file.h"
#include "tools/common.h"
#include "tools/plan/graft_report.h"
#include "tools/plan/plan_command.h"
#include "tools/plan/plan_report.h"

namespace condyle {
namespace {

struct PlanResectOptions {
  std::filesystem::path file;
  std::string segment;
  std::string patient;
  std::optional<int> from, to;  // teeth
  double kerf_mm = 0.5;
  bool below_margins = false;
};

/// Refuses cuts that come too near to a danger zone of the user's own.
void refuse_own_zones(const Plan& plan, const Operated& operated, int step) {
  for (const CutReport& cut : operated.cuts)
    for (const DangerFinding& finding : cut.dangers) {
      const bool own = std::any_of(plan.zones.begin(), plan.zones.end(),
                                   [&](const auto& zone) { return zone.name == finding.zone; });
      if (cut.step == step && own && finding.level == DangerLevel::stop)
        throw InputError(fmt::format(
            "{} is not added: {}. Choose other teeth, or add it all the same with --below-margins",
            cut.title, danger_text(finding)));
    }
}

/// Saves an edited plan unless a step of it cannot be done. Returns what it does to the patient.
/// `zones_of`: id of a cut that keeps clear of the user's own danger zones; 0: none.
Operated save_applied(const Plan& plan, const Case& patient, const std::filesystem::path& file,
                      const std::string& edit, const CommonOptions& common, int zones_of = 0) {
  Operated operated = apply_plan(patient, plan);
  std::vector<std::string> problems = operated.problems;
  std::erase_if(problems, [&](const std::string& problem) {
    return problem.find("(" + edit + ")") == std::string::npos;
  });
  if (!problems.empty())
    throw InputError(fmt::format("{} is not added: {}", edit, fmt::join(problems, "; ")));
  if (zones_of > 0) refuse_own_zones(plan, operated, zones_of);
  finish_edit(plan, file, edit, common);
  print_plan_notes(common, operated.notes);
  return operated;
}

int run_plan_resect(const PlanResectOptions& options, const CommonOptions& common) {
  Plan plan = load_plan(options.file);
  if (options.from.has_value() != options.to.has_value())
    throw InputError("--from and --to go together: the first and the last tooth that is resected");
  if (options.from) {
    // A resection divides the nerve canal and passes beside roots.
    CutStep cut{.osteotomy = "segmental_resection",
                .parameters = {{"from_tooth", *options.from}, {"to_tooth", *options.to}},
                .kerf_mm = options.kerf_mm,
                .pieces = {options.segment},
                .below_margins = true};
    plan = with_step(std::move(plan), cut);
  } else {
    check_segment(plan, options.segment);
  }
  const int cut = plan.steps.empty() ? 0 : plan.steps.back().id;
  const ResectStep step{options.segment};
  plan = with_step(std::move(plan), step);
  const Case patient = open_planned(options.patient, plan, common);
  const Operated operated = save_applied(plan, patient, options.file, step_title(step), common,
                                         options.below_margins ? 0 : cut);
  if (common.prints_summary())
    fmt::print(stderr, "{}{}", options.from ? cut_report_text(operated, cut) : "",
               graft_report_text(plan, operated));
  return 0;
}

struct PlanGraftOptions {
  std::filesystem::path file;
  std::string segment;  // whose place it takes
  std::string patient;
  std::string name = "graft";
  std::optional<std::string> donor, approach;
  std::optional<int> pieces;
  std::vector<std::vector<double>> along;
  std::optional<double> height_mm, roll_deg, kerf_mm, spacing_mm, clearance_mm;
  std::vector<double> starts_mm;
};

/// The donor as a plan stores it: a built-in name, or the whole path of a file.
std::string donor_named(const std::string& donor) {
  const auto& known = donor_names();
  if (std::find(known.begin(), known.end(), donor) != known.end()) return donor;
  if (!std::filesystem::is_regular_file(donor))
    throw InputError(
        fmt::format("--donor {}: is neither a file nor a built-in donor{}; there are "
                    "{}",
                    donor, suggestion(donor, known), fmt::join(known, ", ")));
  return std::filesystem::absolute(donor).lexically_normal().string();
}

/// The step with the options that are given; other values stay.
GraftStep changed_graft(GraftStep step, const PlanGraftOptions& options) {
  step.name = options.name;
  if (!options.segment.empty()) step.replaces = options.segment;
  if (options.donor) {
    step.donor = donor_named(*options.donor);
    step.donor_shape = donor_shape(step.donor);
  }
  step.pieces = options.pieces.value_or(step.pieces);
  if (!options.along.empty()) step.curve.clear();
  for (const auto& p : options.along) step.curve.emplace_back(p[0], p[1], p[2]);
  if (options.height_mm) step.height_mm = options.height_mm;
  step.roll_deg = options.roll_deg.value_or(step.roll_deg);
  step.kerf_mm = options.kerf_mm.value_or(step.kerf_mm);
  step.spacing_mm = options.spacing_mm.value_or(step.spacing_mm);
  step.clearance_mm = options.clearance_mm.value_or(step.clearance_mm);
  if (options.pieces) step.starts_mm.clear();  // they were those of other pieces
  if (!options.starts_mm.empty()) step.starts_mm = options.starts_mm;
  step.approach = options.approach.value_or(step.approach);
  return step;
}

const PlanStep* known_graft(const Plan& plan, const std::string& name) {
  for (const PlanStep& step : plan.steps)
    if (const auto* graft = std::get_if<GraftStep>(&step.action))
      if (graft->name == name) return &step;
  return nullptr;
}

int run_plan_graft(const PlanGraftOptions& options, const CommonOptions& common) {
  const Plan before = load_plan(options.file);
  const PlanStep* known = known_graft(before, options.name);
  const GraftStep step =
      changed_graft(known ? std::get<GraftStep>(known->action) : GraftStep{}, options);
  const Plan plan = known ? with_replaced(before, known->id, step) : with_step(before, step);
  const Case patient = open_planned(options.patient, plan, common);
  const Operated operated = save_applied(plan, patient, options.file, step_title(step), common);
  if (common.prints_summary())
    fmt::print(stderr, "{}", graft_report_text(plan, operated, step.name));
  return 0;
}

}  // namespace

void add_plan_resect(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanResectOptions>();
  CLI::App& command = commands.add_below(
      plan, "resect", "Remove a segment from the patient, with its teeth",
      "condyle plan resect plan.json tumour --from 34 --to 37",
      [options](const CommonOptions& common) { return run_plan_resect(*options, common); });
  add_plan_argument(command, options->file);
  command
      .add_option("SEGMENT", options->segment,
                  "A segment of an earlier cut; with --from and --to the name of the new one")
      ->required();
  command.add_flag("--below-margins", options->below_margins,
                   "Allow a cut that lies too near to a danger zone of the user's own");
  in_range(command.add_option("--from", options->from,
                              "Cut the lower jaw beside this tooth, the first that is resected "
                              "(FDI number)"),
           31, 48);
  in_range(command.add_option("--to", options->to, "And beside this one, the last"), 31, 48);
  in_range(command.add_option("--kerf", options->kerf_mm,
                              "Thickness of these saw cuts, mm; default 0.5"),
           0, max_kerf_mm);
  add_plan_case(command, options->patient);
}

void add_plan_graft(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanGraftOptions>();
  CLI::App& command = commands.add_below(
      plan, "graft", "Put bone from elsewhere in the place of a resected segment, or change it",
      "condyle plan graft plan.json tumour --donor fibula --pieces 2",
      [options](const CommonOptions& common) { return run_plan_graft(*options, common); });
  add_plan_argument(command, options->file);
  command.add_option("SEGMENT", options->segment,
                     "The resected segment; of a graft that is changed, as it is");
  command.add_option("--name", options->name, "Of the graft and its pieces; default graft")
      ->type_name("NAME");
  command
      .add_option("--donor", options->donor,
                  "fibula (default), iliac_block, rib, or a file with a closed surface in mm")
      ->type_name("NAME|FILE");
  in_range(command.add_option("--pieces", options->pieces, "Number of pieces; default 1"), 1,
           max_graft_pieces);
  command
      .add_option("--along", options->along,
                  "A point of the graft's axis; two or more, else it follows the lower border")
      ->delimiter(',')
      ->expected(3)
      ->allow_extra_args(false)
      ->type_name("X,Y,Z");
  in_range(command.add_option("--height", options->height_mm,
                              "Height of the axis above the lower border, mm; default half of the "
                              "donor's"),
           0, 60);
  in_range(command.add_option("--roll", options->roll_deg,
                              "Rotation of the donor about its axis, degrees; default 0"),
           -180, 180);
  in_range(command.add_option("--kerf", options->kerf_mm,
                              "Thickness of the saw on the donor, mm; default 0.5"),
           0, 2);
  in_range(command.add_option("--spacing", options->spacing_mm,
                              "Between neighbouring saw cuts beyond the kerf, mm; default 0.5"),
           0, 20);
  in_range(command.add_option("--clearance", options->clearance_mm,
                              "Between the end faces and the jaw, mm; default 0.2"),
           0, 5);
  command
      .add_option("--starts", options->starts_mm,
                  "Where each piece begins on the donor's axis, mm; default: one after another")
      ->delimiter(',')
      ->type_name("MM,...");
  command
      .add_option("--approach", options->approach,
                  "Side that the surgeon works from: submandibular (default) or intraoral")
      ->type_name("SIDE");
  add_plan_case(command, options->patient);
}

}  // namespace condyle
