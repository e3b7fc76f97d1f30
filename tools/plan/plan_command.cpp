#include "tools/plan/plan_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "engine/core/error.h"
#include "engine/core/similar_word.h"
#include "sim/operation/cut_text.h"
#include "sim/phantom/phantom.h"
#include "sim/plan/plan_file.h"
#include "sim/plan/plan_history_file.h"
#include "tools/commands.h"
#include "tools/common.h"

namespace condyle {

namespace fs = std::filesystem;

void add_plan_argument(CLI::App& command, fs::path& file) {
  command.add_option("PLAN", file, "File of the plan")->required();
}

void add_step_argument(CLI::App& command, int& step) {
  in_range(command.add_option("STEP", step, "Number of the step")->required(), 1, 1000000);
}

void add_plan_case(CLI::App& command, std::string& patient, const char* absent) {
  command.add_option("--case", patient, fmt::format("The case of the plan (default: {})", absent))
      ->type_name("FOLDER|built-in");
}

Case open_planned(const std::string& patient, const std::optional<Plan>& plan,
                  const CommonOptions& common) {
  ProgressBar bar(common);
  Case opened = open_patient(case_of(patient, plan), common, bar);
  bar.clear();
  return opened;
}

std::optional<Case> case_of_plan(const std::string& patient, const Plan& plan,
                                 const CommonOptions& common) {
  if (!patient.empty()) return open_planned(patient, plan, common);
  const std::string& name = plan.geometry.name;
  if (name != builtin_case_name && !is_head_name(name)) return std::nullopt;
  Case head = open_planned({}, plan, common);
  if (compare_geometry(plan.geometry, geometry_of(head)).match == CaseMatch::other_case)
    return std::nullopt;
  return head;
}

void print_plan_notes(const CommonOptions& common, const std::vector<std::string>& notes) {
  if (!common.prints_summary()) return;
  for (const auto& note : notes) fmt::print(stderr, "note: {}\n", note);
}

void print_edited(const Plan& plan, const fs::path& file, const CommonOptions& common) {
  if (common.json) fmt::print("{}", plan_json(plan));
  if (common.prints_summary())
    fmt::print(stderr, "{}: {}, {} step{}\n{}{}", file.string(), plan.name, plan.steps.size(),
               plan.steps.size() == 1 ? "" : "s", steps_text(plan), zones_text(plan));
}

void finish_edit(const Plan& plan, const fs::path& file, const std::string& edit,
                 const CommonOptions& common) {
  const auto notes = save_edit(plan, file, edit);
  print_edited(plan, file, common);
  print_plan_notes(common, notes);
}

void check_segment(const Plan& plan, const std::string& segment) {
  std::vector<std::string> known = {"mandible", "cranium"};
  for (const PlanStep& step : plan.steps)
    if (const auto* cut = std::get_if<CutStep>(&step.action)) {
      known.insert(known.end(), cut->pieces.begin(), cut->pieces.end());
    } else if (const auto* graft = std::get_if<GraftStep>(&step.action)) {
      const auto bodies = graft_bodies(*graft);
      known.insert(known.end(), bodies.begin(), bodies.end());
    }
  for (const PartGeometry& part : plan.geometry.parts)
    if (part.name.starts_with("segment") || part.name.starts_with("transplant"))
      known.push_back(part.name);
  if (std::find(known.begin(), known.end(), segment) != known.end()) return;
  throw InputError(fmt::format("no step of the plan makes \"{}\"{}; known are {}", segment,
                               suggestion(segment, known), fmt::join(known, ", ")));
}

void add_plan(Commands& commands) {
  CLI::App& plan = commands.add_parent("plan", "Plan an operation: cuts and moves of segments",
                                       "condyle plan new --out plan.json\n"
                                       "  condyle plan cut plan.json le_fort_1\n"
                                       "  condyle plan move plan.json maxilla forward 4 up 2");
  for (const auto add : {add_plan_new, add_plan_cut, add_plan_edit, add_plan_move, add_plan_occlude,
                         add_plan_trim, add_plan_resect, add_plan_graft, add_plan_zone,
                         add_plan_note, add_plan_reorder, add_plan_remove, add_plan_undo,
                         add_plan_redo, add_plan_show, add_plan_apply, add_plan_compare})
    add(commands, plan);
}

}  // namespace condyle
