#include "sim/appliance/guide.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "sim/appliance/appliance_text.h"
#include "sim/plan/plan_file.h"
#include "tools/appliance/appliance_output.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/plan/plan_command.h"

namespace condyle {
namespace {

struct GuideOptions {
  std::filesystem::path plan;
  std::string patient, cut, saw = "sagittal", side = "both", from;
  GuideSettings settings;
  ApplianceFiles files;
};

const Choices<GuideSide> sides = {
    {"both", GuideSide::both}, {"left", GuideSide::left}, {"right", GuideSide::right}};
const Choices<Eigen::Vector3d> views = {{"front", -Eigen::Vector3d::UnitY()},
                                        {"left", Eigen::Vector3d::UnitX()},
                                        {"right", -Eigen::Vector3d::UnitX()},
                                        {"below", -Eigen::Vector3d::UnitZ()},
                                        {"above", Eigen::Vector3d::UnitZ()}};

std::string saw_words() {
  std::string words;
  for (const Saw& saw : known_saws()) words += saw.name + "|";
  return words + "MM";
}

int run_guide(const GuideOptions& options, const CommonOptions& common) {
  GuideSettings settings = options.settings;
  settings.threads = common.threads;
  settings.saw = find_saw(options.saw);
  settings.side = chosen(sides, "--side", options.side);
  if (!options.from.empty()) settings.from = chosen(views, "--from", options.from);
  check_files(options.files);
  const Plan plan = load_plan(options.plan);
  const Case patient = open_planned(options.patient, plan, common);
  const CutLine line = find_cut_line(apply_cuts(patient, plan), plan, options.cut);
  ProgressBar bar(common);
  std::vector<std::string> notes;
  const GuideSupport support = guide_support(patient, plan, line, notes);
  Guide guide = make_guide(support, line, settings, bar.callback());
  bar.clear();
  guide.notes.insert(guide.notes.begin(), notes.begin(), notes.end());
  write_appliance(guide.mesh, options.files);
  print_plan_notes(common, guide.notes);
  const std::string title = "guide for " + line.title;
  if (!options.files.picture.empty())
    write_guide_picture(guide, patient, {title + " of " + plan.name, guide_text(guide, settings)},
                        options.files.picture);
  if (common.json) {
    nlohmann::ordered_json json{
        {"cut", line.title}, {"step", line.step}, {"file", options.files.out.string()}};
    json.update(guide_json(guide, settings));
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  }
  if (common.prints_summary())
    fmt::print(stderr, "{}: {}\n{}", options.files.out.string(), title,
               guide_text(guide, settings));
  return 0;
}

}  // namespace

void add_guide(Commands& commands) {
  const auto options = std::make_shared<GuideOptions>();
  CLI::App& command =
      commands.add("guide", "Make a guide that leads the saw along a planned cut",
                   "condyle guide plan.json --cut genioplasty --saw sagittal --out guide.stl",
                   [options](const CommonOptions& common) { return run_guide(*options, common); });
  add_plan_argument(command, options->plan);
  add_plan_case(command, options->patient);
  command
      .add_option("--cut", options->cut,
                  "The cut: number of its step, its osteotomy, or a segment that it makes")
      ->required();
  command
      .add_option("--saw", options->saw,
                  "The saw by name, or its blade's thickness; default sagittal")
      ->type_name(saw_words());
  command.add_option("--side", options->side, "The side of the patient; default both")
      ->type_name(words_of(sides));
  command
      .add_option("--from", options->from,
                  "Where the guide comes from; default the direction that shows most of the cut")
      ->type_name(words_of(views));
  add_appliance_files(command, options->files);
  begin_group(command, "Shape");
  GuideSettings& settings = options->settings;
  const auto add = [&](const char* name, double& value, const char* what, double low, double high) {
    in_range(command.add_option(name, value, fmt::format("{}; default {} mm", what, value)), low,
             high);
  };
  add("--tolerance", settings.tolerance_mm, "Room at each side of the blade", 0, 1);
  add("--reach", settings.reach_mm, "Width of the shell on each side of the cut", 6, 25);
  add("--shell", settings.shell_mm, "Thickness of the shell", 1.2, 6);
  add("--height", settings.height_mm, "Height of the slot's walls", 2, 20);
  add("--slot-wall", settings.slot_wall_mm, "Thickness of the slot's walls", 1.2, 5);
  add("--hole", settings.hole_mm, "Diameter of the screw holes, 0 for none", 0, 4);
  add("--gap", settings.gap_mm, "Gap between bone and shell", 0, 0.5);
  add("--grip", settings.grip_mm, "Deepest undercut that the shell holds", 0, 1);
  add("--voxel", settings.voxel_mm, "Spacing of the samples", least_voxel_mm, largest_voxel_mm);
}

}  // namespace condyle
