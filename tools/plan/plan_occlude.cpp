#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "engine/collide/distance_field.h"
#include "engine/core/user_cache.h"
#include "sim/operated/segment_bite.h"
#include "sim/plan/plan_file.h"
#include "tools/common.h"
#include "tools/plan/plan_command.h"

namespace condyle {
namespace {

struct PlanOccludeOptions {
  std::filesystem::path file;
  std::string segment, patient;
  bool scanned = false;
};

std::string bite_text(const SegmentBite& found) {
  const Bite& bite = found.bite;
  return fmt::format(
      "{} contact{} on 0.1 mm film, {:.0f} % of the load left; overjet {:.1f} mm, "
      "overbite {:.1f} mm\n",
      bite.contacts.size(), bite.contacts.size() == 1 ? "" : "s", 100 * bite.left_fraction,
      bite.after.overjet_mm, bite.after.overbite_mm);
}

int run_plan_occlude(const PlanOccludeOptions& options, const CommonOptions& common) {
  constexpr int no_stable_bite = 1;
  const Plan plan = load_plan(options.file);
  check_segment(plan, options.segment);
  const Case patient = open_planned(options.patient, plan, common);
  OcclusionSettings settings;
  settings.threads = common.threads;
  settings.cache = user_cache_folder();
  ProgressBar bar(common);
  const SegmentBite found =
      find_segment_bite(patient, plan, options.segment, settings, bar.callback(),
                        options.scanned ? SegmentBiteStart::scanned : SegmentBiteStart::normal);
  bar.clear();
  if (!found.bite.stable) {
    fmt::print(stderr, "condyle: {} is not placed: no stable bite, {}\n", options.segment,
               found.bite.unstable_because);
    return no_stable_bite;
  }
  finish_edit(with_segment_bite(plan, options.segment, found), options.file,
              "occlude " + options.segment, common);
  if (common.prints_summary()) fmt::print(stderr, "{}", bite_text(found));
  return 0;
}

}  // namespace

void add_plan_occlude(Commands& commands, CLI::App& plan) {
  const auto options = std::make_shared<PlanOccludeOptions>();
  CLI::App& command = commands.add_below(
      plan, "occlude", "Place a segment with a dental arch in maximum intercuspation",
      "condyle plan occlude plan.json distal --case built-in:class-iii",
      [options](const CommonOptions& common) { return run_plan_occlude(*options, common); });
  add_plan_argument(command, options->file);
  command.add_option("SEGMENT", options->segment, "Its name")->required();
  add_plan_case(command, options->patient);
  command.add_flag("--scanned-bite", options->scanned,
                   "Start from the bite that was scanned with the dental arches (condyle import "
                   "teeth), such as one set by hand, instead of normal incisors");
}

}  // namespace condyle
