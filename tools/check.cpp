#include <fmt/format.h>

#include "engine/core/files.h"
#include "sim/report/clearance.h"
#include "tools/common.h"

namespace condyle {

int run_check(const CheckOptions& options, const CommonOptions& common) {
  constexpr int violation = 3;
  ProgressBar bar(common);
  const auto settings = simulator_settings(options.motion, common);
  const Scene scene =
      make_scene(open_patient(options.motion.patient, common, bar), settings, bar.callback());
  const Motion motion =
      make_motion(options.motion.motion, scene.patient, scene.contacts, options.motion.opening);
  const auto check = check_clearance(scene, motion, options.margin_mm, settings, bar.callback());
  bar.clear();
  const std::string json = check.json(scene, motion, options.margin_mm);
  if (!options.out.empty()) {
    make_folder(options.out);
    write_file(options.out / "pairs.csv", check.pairs_csv);
    write_file(options.out / "report.json", json);
  }
  if (common.json) fmt::print("{}", json);
  if (!common.quiet) {
    for (const auto& note : scene.contacts.notes()) fmt::print(stderr, "note: {}\n", note);
    fmt::print(stderr, "{}", check.text(options.margin_mm));
  }
  return check.violated() ? violation : 0;
}

}  // namespace condyle
