#include "tools/demo/demo.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>

#include "engine/core/error.h"
#include "engine/core/similar_word.h"
#include "tools/commands.h"

namespace condyle {
namespace {

const std::array<Demo, 6> demos{
    {{"class-iii", "both jaws in class III, with the face afterwards", run_class_iii},
     {"jaw-before-after", "jaw movement before and after that operation", run_jaw_before_after},
     {"vault", "a vault with craniosynostosis, cut into panels and reshaped", run_vault},
     {"genioplasty", "a chin moved forward, with the mouth opening afterwards", run_genioplasty},
     {"fibula", "a resected jaw rebuilt from three pieces of a fibula", run_fibula},
     {"bimaxillary-by-hand", "both jaws planned in the window by mouse and keyboard",
      run_by_hand}}};

std::vector<std::string> demo_names() {
  std::vector<std::string> names;
  for (const Demo& demo : demos) names.push_back(demo.name);
  return names;
}

int run_demo(const std::string& name, const DemoOptions& options, const CommonOptions& common) {
  const auto demo =
      std::find_if(demos.begin(), demos.end(), [&](const Demo& d) { return d.name == name; });
  if (demo == demos.end())
    throw InputError(fmt::format("no demonstration is called \"{}\"{}; known are {}", name,
                                 suggestion(name, demo_names()), fmt::join(demo_names(), ", ")));
  if (name != "vault" && !(options.skull.empty() && options.landmarks.empty()))
    throw InputError("--skull and --landmarks belong to the demonstration vault");
  if (options.skull.empty() && !options.landmarks.empty())
    throw InputError("--landmarks needs --skull");
  return demo->run(options, common);
}

}  // namespace

void add_demo(Commands& commands) {
  const auto options = std::make_shared<DemoOptions>();
  const auto name = std::make_shared<std::string>();
  CLI::App& command = commands.add(
      "demo", "Repeat an operation on a built-in patient",
      "condyle demo class-iii --out out/class-iii",
      [options, name](const CommonOptions& common) { return run_demo(*name, *options, common); });
  std::string what;
  for (const Demo& demo : demos)
    what += fmt::format("{}{} ({})", what.empty() ? "One of " : "; ", demo.name, demo.what);
  command.add_option("NAME", *name, what)->required();
  command
      .add_option("--out", options->out,
                  "Folder for plan.json, segments, pictures, report.html and report.json")
      ->type_name("FOLDER")
      ->required();
  command.add_option("--skull", options->skull, "For vault: mesh of a skull, mm, LPS")
      ->type_name("FILE");
  command
      .add_option("--landmarks", options->landmarks,
                  "Landmarks of that skull (CSV); without them they are estimated")
      ->type_name("FILE");
}

}  // namespace condyle
