#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "sim/case/case_io.h"
#include "tools/commands.h"
#include "tools/common.h"

namespace condyle {
namespace {

int run_phantom(const std::filesystem::path& out, const CommonOptions& common) {
  ProgressBar bar(common);
  const Case patient = open_patient({}, common, bar);
  bar.clear();
  save_case(patient, out);
  if (common.prints_summary())
    fmt::print(stderr, "{}: the built-in patient, {} parts, {} landmarks\n", out.string(),
               patient.parts.size(), patient.landmarks.points.size());
  return 0;
}

}  // namespace

void add_phantom(Commands& commands) {
  const auto out = std::make_shared<std::filesystem::path>();
  CLI::App& command = commands.add(
      "phantom", "Write the built-in patient as a case folder", "condyle phantom --out patient",
      [out](const CommonOptions& common) { return run_phantom(*out, common); });
  command.add_option("--out", *out, "Folder of the case")->type_name("FOLDER")->required();
}

}  // namespace condyle
