#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "engine/core/error.h"
#include "engine/core/text_list.h"
#include "sim/operation/edit_cut.h"
#include "sim/operation/segment_overlaps.h"
#include "sim/operation/trim_segments.h"
#include "sim/plan/plan_file.h"
#include "tools/plan/plan_command.h"
#include "tools/plan/plan_report.h"

namespace condyle {
namespace {

struct PlanTrimOptions {
  std::filesystem::path file;
  std::string segment, others, patient;
  bool below_margins = false;
};

/// The step that trims the segment already.
const PlanStep* known_trim(const Plan& plan, const std::string& segment) {
  for (const PlanStep& step : plan.steps)
    if (const auto* trim = std::get_if<TrimStep>(&step.action); trim && trim->segment == segment)
      return &step;
  return nullptr;
}

/// The segments to which it gives way: the requested ones, or all that it overlaps. throws:
/// InputError where nothing overlaps.
std::vector<std::string> others_of(const PlanTrimOptions& options, const Operated& operated) {
  const auto found = trimming_segments(operated, options.segment);
  if (found.empty())
    throw InputError(
        fmt::format("{} overlaps no other segment of its bone at the planned "
                    "positions: there is nothing to trim",
                    options.segment));
  if (options.others.empty()) return found;
  const auto others = split_list(options.others);
  for (const std::string& other : others)
    if (std::find(found.begin(), found.end(), other) == found.end())
      throw InputError(
          fmt::format("{} and {} do not overlap at the planned positions; {} overlaps "
                      "{}",
                      options.segment, other, options.segment, fmt::join(found, ", ")));
  return others;
}

/// Refuses a trim that could not be done, or that comes too near to a root, canal or foramen.
void check_trim(const Operated& operated, const PlanStep& step) {
  for (const std::string& problem : operated.problems)
    if (problem.starts_with(step_name(step))) throw InputError(problem);
  if (const std::string dangers = dangers_below_margins(operated, step.id); !dangers.empty())
    throw InputError(
        fmt::format("{} is not added: {}. Trim the other segment, or add it all the same with "
                    "--below-margins",
                    step_title(step.action), dangers));
}

/// The overlaps with bone of the segment that are left.
std::vector<std::string> left_overlaps(const Operated& operated, const std::string& segment) {
  std::vector<std::string> texts;
  for (const SegmentOverlap& overlap : body_overlaps(operated, segment))
    if (overlap.kind == SegmentOverlap::Kind::trimmed)
      texts.push_back(overlap_text(overlap, present_landmarks(operated)));
  if (texts.empty()) texts.push_back("no overlapping bone of " + segment + " is left");
  return texts;
}

int run_plan_trim(const PlanTrimOptions& options, const CommonOptions& common) {
  const Plan plan = load_plan(options.file);
  check_segment(plan, options.segment);
  const auto patient = case_of_plan(options.patient, plan, common);
  if (!patient) throw InputError("the overlap depends on the bones: give the case with --case");
  const PlanStep* known = known_trim(plan, options.segment);
  const Plan before = known ? without_step(plan, known->id) : plan;
  const TrimStep trim{options.segment, others_of(options, apply_plan(*patient, before)),
                      options.below_margins};
  const Plan edited = known ? with_replaced(plan, known->id, trim) : with_step(plan, trim);
  const PlanStep& step = known ? step_of(edited, known->id) : edited.steps.back();
  const Operated operated = apply_plan(*patient, edited);
  check_trim(operated, step);
  finish_edit(edited, options.file, step_title(trim), common);
  print_plan_notes(common, operated.notes);
  if (common.prints_summary()) fmt::print(stderr, "{}", cut_report_text(operated, step.id));
  print_plan_notes(common, left_overlaps(operated, options.segment));
  return 0;
}

}  // namespace

void add_plan_trim(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanTrimOptions>();
  CLI::App& command = commands.add_below(
      plan, "trim", "Remove the bone of a segment that overlaps others as planned",
      "condyle plan trim plan.json distal --of proximal_left",
      [options](const CommonOptions& common) { return run_plan_trim(*options, common); });
  add_plan_argument(command, options->file);
  command.add_option("SEGMENT", options->segment, "The segment that loses bone")->required();
  command
      .add_option("--of", options->others,
                  "Segments that keep theirs; default all that it overlaps")
      ->type_name("A,B,...");
  add_plan_case(command, options->patient, "the built-in head that the plan names");
  command.add_flag("--below-margins", options->below_margins,
                   "Allow a trim that lies too near to a root, canal or foramen");
}

}  // namespace condyle
