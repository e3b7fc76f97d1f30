#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "sim/case/case_io.h"
#include "sim/phantom/head_shape.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/phantom_scan.h"

namespace condyle {
namespace {

struct PhantomOptions {
  std::filesystem::path out;
  std::string variant = "standard";
  std::uint64_t seed = 0;
  std::string scan;  // empty: the case
  bool touching_teeth = false;
  PhantomScanRequest scans;
};

int run_scan(const PhantomOptions& options, const HeadChoice& choice, const Case& patient,
             const CommonOptions& common, ProgressBar& bar) {
  PhantomScanRequest request = options.scans;
  request.ct = options.scan != "laser";
  request.laser = options.scan != "ct";
  constexpr double touching_mm = 0.1;
  if (options.touching_teeth) request.tooth_growth_mm = touching_mm;
  write_scans(patient, choice, request, common, bar, options.out);
  bar.clear();
  if (common.prints_summary())
    fmt::print(stderr, "{}: {} of {}, and the truth\n", options.out.string(),
               options.scan == "all" ? "CT and laser scan"
               : request.ct          ? "CT"
                                     : "laser scan",
               patient.name);
  return 0;
}

int run_phantom(const PhantomOptions& options, const CommonOptions& common) {
  const std::filesystem::path& out = options.out;
  const HeadChoice choice{.variant = head_variant(options.variant), .seed = options.seed};
  ProgressBar bar(common);
  const Case patient = open_patient(head_name(choice), common, bar);
  if (!options.scan.empty()) return run_scan(options, choice, patient, common, bar);
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
      "condyle phantom --variant class-iii --out patient\n"
      "  condyle phantom --scan all --seed 3 --out scans",
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
  begin_group(command, "Scans, with the truth beside them");
  PhantomScanRequest& scans = options->scans;
  command
      .add_option(
          "--scan", options->scan,
          "The head as scanners give it: ct (NRRD and DICOM), laser (depth and colour), all")
      ->type_name("ct|laser|all")
      ->check(CLI::IsMember({"ct", "laser", "all"}));
  in_range(
      command.add_option("--voxel", scans.voxel_mm, "Edge of the CT's voxels, mm; default 0.8"),
      0.3, 3);
  in_range(command.add_option("--noise", scans.ct_settings.noise_hu,
                              "Noise of the CT, Hounsfield units; default 40"),
           0, 400);
  in_range(command.add_option("--point-spread", scans.ct_settings.point_spread,
                              "Blur of the CT, voxels; default 0.5"),
           0, 2);
  in_range(command.add_option("--noise-seed", scans.seed,
                              "Of noise, poses and errors of the landmarks; default 1"),
           0, 1e15);
  command.add_flag("--fillings", scans.ct_settings.fillings, "Three fillings with streaks");
  command.add_flag("--table", scans.ct_settings.table, "Table and head rest");
  command.add_flag("--dark-marrow", scans.ct_settings.dark_marrow, "Marrow of 50 to 250 HU");
  command.add_flag("--touching-teeth", options->touching_teeth, "Teeth that touch");
}

}  // namespace condyle
