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
  std::string patient, cut, on, saw = "sagittal", side = "both", from;
  GuideSettings settings;
  ApplianceFiles files;
};

const Choices<GuideSide> sides = {
    {"both", GuideSide::both}, {"left", GuideSide::left}, {"right", GuideSide::right}};
// In the clinical frame: left, back, up.
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
  const CutLine line = find_cut_line(apply_cuts(patient, plan), plan, options.cut, options.on);
  ProgressBar bar(common);
  std::vector<std::string> notes;
  const GuideSupport support = guide_support(patient, plan, line, notes);
  Guide guide = make_guide(support, line, settings, bar.callback());
  bar.clear();
  guide.notes.insert(guide.notes.begin(), notes.begin(), notes.end());
  const ApplianceReport report{"guide for " + line.title,
                               plan.name,
                               guide_text(guide, settings),
                               guide.notes,
                               [&] {
                                 nlohmann::ordered_json json{{"cut", line.title},
                                                             {"step", line.step},
                                                             {"file", options.files.out.string()}};
                                 json.update(guide_json(guide, settings));
                                 return json;
                               }(),
                               [&](const PictureText& text, const std::filesystem::path& file) {
                                 write_guide_picture(guide, patient, text, file);
                               }};
  finish_appliance(guide.mesh, report, options.files, common);
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
      .add_option("--on", options->on,
                  "The bone, where the cut passes through several; default that with most of it")
      ->type_name("BONE");
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
  add_lengths(command, options->settings, guide_lengths);
}

}  // namespace condyle
