#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "sim/case/case_io.h"
#include "sim/comparison/plan_comparison.h"
#include "sim/plan/plan_file.h"
#include "tools/common.h"
#include "tools/plan/plan_command.h"

namespace condyle {
namespace {

struct PlanCompareOptions {
  std::filesystem::path plan, other;
  std::string patient;
};

int run_plan_compare(const PlanCompareOptions& options, const CommonOptions& common) {
  const Plan plan = load_plan(options.plan);
  ProgressBar bar(common);
  const Case patient = open_patient(options.patient, common, bar);
  const ClinicalFrame frame = clinical_frame(patient.landmarks, plan.reference);
  const Operated planned = apply_plan(patient, plan);
  PlanComparison comparison;
  if (std::filesystem::is_directory(options.other)) {
    comparison = compare_with_case(planned, load_case(options.other), frame, common.threads);
  } else {
    const Plan other = load_plan(options.other);
    comparison = compare_plans(planned, apply_plan(patient, other), frame);
    if (plan.name != other.name) {
      comparison.first = plan.name;
      comparison.second = other.name;
    }
  }
  bar.clear();
  if (common.json) fmt::print("{}\n", plan_comparison_json(comparison).dump(2));
  if (!common.quiet)
    for (const auto& note : comparison.notes) fmt::print(stderr, "note: {}\n", note);
  if (!common.json) fmt::print("{}", plan_comparison_text(comparison));
  return 0;
}

}  // namespace

void add_plan_compare(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanCompareOptions>();
  CLI::App& command = commands.add_below(
      plan, "compare", "Compare two plans of a case, or a plan with the operated patient",
      "condyle plan compare plan.json other.json --case mycase\n"
      "  condyle plan compare plan.json postoperative --case mycase",
      [options](const CommonOptions& common) { return run_plan_compare(*options, common); });
  add_plan_argument(command, options->plan);
  command
      .add_option("OTHER", options->other,
                  "File of the other plan, or folder of a case after the operation")
      ->required();
  add_plan_case(command, options->patient);
}

}  // namespace condyle
