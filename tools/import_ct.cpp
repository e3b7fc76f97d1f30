#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "engine/core/error.h"
#include "engine/dicom/ct_volume.h"
#include "engine/volume/volume_files.h"
#include "tools/commands.h"
#include "tools/common.h"
#include "tools/series_list.h"

namespace condyle {
namespace {

struct CtImportOptions {
  std::filesystem::path scan;  // folder or file
  CtRequest request;
  bool list = false;
  std::filesystem::path out, volume_out;
};

void check_volume_name(const std::filesystem::path& file) {
  if (file.extension() != ".nrrd")
    throw InputError(file, "--volume-out", "must have the extension .nrrd");
}

int list_series(const CtImportOptions& options, const CommonOptions& common) {
  if (!std::filesystem::is_directory(options.scan))
    throw InputError(options.scan, "--list", "is not a folder; condyle info describes a file");
  ProgressBar bar(common);
  const CtFolder folder(options.scan, common.threads, bar.callback());
  bar.clear();
  print_series(folder, options.scan, common);
  return 0;
}

int run_import_ct(const CtImportOptions& options, const CommonOptions& common) {
  if (options.list) return list_series(options, common);
  if (!options.out.empty())
    throw InputError(
        "--out: import ct does not make a case yet; it lists the series (--list) and "
        "writes the volume (--volume-out FILE.nrrd)");
  if (options.volume_out.empty())
    throw InputError(
        "import ct needs --list or --volume-out FILE.nrrd. See condyle import ct "
        "--help");
  check_volume_name(options.volume_out);
  CtRequest request = options.request;
  request.threads = common.threads;
  ProgressBar bar(common);
  const CtVolume ct = ct_volume(options.scan, request, bar.callback());
  bar.show("writing", 0);
  write_nrrd(ct.volume, options.volume_out);
  bar.clear();
  if (common.prints_summary()) {
    for (const std::string& note : ct.notes) fmt::print(stderr, "note: {}\n", note);
    fmt::print(stderr, "{}: {} x {} x {} values, {:.3g} x {:.3g} x {:.3g} mm apart\n",
               options.volume_out.string(), ct.volume.size[0], ct.volume.size[1], ct.volume.size[2],
               ct.volume.spacing_mm.x(), ct.volume.spacing_mm.y(), ct.volume.spacing_mm.z());
  }
  return 0;
}

}  // namespace

void add_import_ct(Commands& commands, CLI::App& import) {
  const auto options = std::make_shared<CtImportOptions>();
  CLI::App& command = commands.add_below(
      import, "ct", "From a CT scan: DICOM, NRRD, MetaImage or NIfTI-1",
      "condyle import ct scan --list\n"
      "  condyle import ct scan --series 2 --volume-out scan.nrrd",
      [options](const CommonOptions& common) { return run_import_ct(*options, common); });
  command
      .add_option("FOLDER|FILE", options->scan,
                  "Folder with DICOM series, or a volume (.nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz)")
      ->required();
  command.add_option("--out", options->out, "Folder of the new case")->type_name("FOLDER");
  command.add_flag("--list", options->list, "List the series of the folder, and stop");
  in_range(command.add_option("--series", options->request.series,
                              "The series to read; default: the largest CT with a step of at most "
                              "3 mm"),
           1, 100000);
  command.add_flag("--resample", options->request.resample,
                   "Interpolate slices that are missing or uneven, which are refused otherwise");
  command
      .add_option("--volume-out", options->volume_out,
                  "Write the volume that was read, in Hounsfield units, LPS (.nrrd)")
      ->type_name("FILE");
}

}  // namespace condyle
