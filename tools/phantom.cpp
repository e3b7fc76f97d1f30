#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "sim/case/case_io.h"
#include "sim/phantom/head_shape.h"
#include "tools/commands.h"
#include "tools/common.h"

namespace condyle {
namespace {

struct PhantomOptions {
  std::filesystem::path out;
  std::string variant = "standard";
  std::uint64_t seed = 0;
};

int run_phantom(const PhantomOptions& options, const CommonOptions& common) {
  const std::filesystem::path& out = options.out;
  const HeadChoice choice{.variant = head_variant(options.variant), .seed = options.seed};
  ProgressBar bar(common);
  const Case patient = open_patient(head_name(choice), common, bar);
  bar.clear();
  save_case(patient, out);
  if (common.prints_summary())
    fmt::print(stderr, "{}: {}, {} parts, {} landmarks\n", out.string(), patient.name,
               patient.parts.size(), patient.landmarks.points.size());
  return 0;
}

}  // namespace

void add_phantom(Commands& commands) {
  const auto options = std::make_shared<PhantomOptions>();
  CLI::App& command = commands.add(
      "phantom", "Write the built-in patient, a variant of it or a random head as a case folder",
      "condyle phantom --variant class-iii --out patient",
      [options](const CommonOptions& common) { return run_phantom(*options, common); });
  command.add_option("--out", options->out, "Folder of the case")->type_name("FOLDER")->required();
  command.add_option("--variant", options->variant, "Shape of the head: " + head_variant_names())
      ->type_name("NAME");
  command
      .add_option(
          "--seed", options->seed,
          "A head with dimensions drawn from published distributions; the same head for the "
          "same number (default 0: the built-in patient's)")
      ->type_name("N");
}

}  // namespace condyle
