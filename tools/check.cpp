#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "render/contact_picture.h"
#include "render/gl_context.h"
#include "sim/report/check_page.h"
#include "sim/report/clearance.h"
#include "tools/common.h"

namespace condyle {
namespace {

/// Overview from the side on which it happens.
std::string overview_of(const PairDetail& detail) {
  if (detail.side == "left" || detail.side == "right") return detail.side;
  return detail.side == "middle" ? "front" : "three-quarter";
}

Image picture_of(const Scene& scene, const ClearanceCheck& check, const PairVerdict& pair,
                 int threads) {
  constexpr double least_mm = 45, most_mm = 90;
  const WorstView view = worst_view(scene, pair, threads);
  ContactPlace place{.parts = view.parts,
                     .fixed = pair.a,
                     .moved = pair.b,
                     .fixed_values = view.distance_a,
                     .moved_values = view.distance_b,
                     .X_CM = pair.X_CM_worst,
                     .place = pair.detail.place,
                     .middle = pair.detail.middle,
                     .normal = pair.detail.normal,
                     .seen_mm = std::clamp(1.3 * pair.detail.size_mm, least_mm, most_mm),
                     .overview = overview_of(pair.detail),
                     .title = pair.a + " and " + pair.b,
                     .lines = {worst_caption(check, pair)}};
  if (const auto words = open_surface_words(pair); !words.empty()) place.lines.push_back(words);
  return contact_picture(place, distance_colours());
}

/// Writes a picture of each pair worth one; gives its file's name, or empty, for every pair.
std::vector<std::string> write_pictures(const std::filesystem::path& folder, const Scene& scene,
                                        const ClearanceCheck& check, int threads,
                                        std::vector<std::string>& notes, const Progress& progress) {
  const auto file_of = [](const PairVerdict& pair) {
    return fmt::format("worst-{}-{}.png", pair.a, pair.b);
  };
  // Those of an earlier check must not be taken for this one's.
  for (const auto& pair : check.pairs) {
    std::error_code none;
    std::filesystem::remove(folder / file_of(pair), none);
  }
  std::vector<std::string> files(check.pairs.size());
  std::optional<OffscreenContext> context;
  try {
    context.emplace();
  } catch (const MachineError& error) {
    notes.push_back(fmt::format("pictures are left out: {}", error.what()));
    return files;
  }
  const auto shown = pairs_to_show(check);
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const auto& pair = check.pairs[shown[k]];
    report(progress, "drawing", static_cast<double>(k) / static_cast<double>(shown.size()));
    files[shown[k]] = file_of(pair);
    write_png(folder / files[shown[k]], picture_of(scene, check, pair, threads));
  }
  return files;
}

}  // namespace

int run_check(const CheckOptions& options, const CommonOptions& common) {
  constexpr int violation = 3;
  ProgressBar bar(common);
  auto settings = simulator_settings(options.motion, common);
  settings.contact.far_mm = std::numeric_limits<double>::infinity();  // every distance is plotted
  const Scene scene =
      make_scene(open_patient(options.motion.patient, common, bar), settings, bar.callback());
  const Motion motion =
      make_motion(options.motion.motion, scene.patient, scene.contacts, options.motion.opening);
  const auto check = check_clearance(scene, motion, options.margin_mm, settings, bar.callback());
  std::vector<std::string> pictures, notes;
  if (!options.out.empty()) {
    make_folder(options.out);
    pictures = write_pictures(options.out, scene, check, common.threads, notes, bar.callback());
  }
  bar.clear();
  const std::string json = check.json(scene, motion, options.margin_mm, pictures, notes);
  if (!options.out.empty()) {
    CheckPage page{scene.patient.name, motion.name, options.margin_mm, pictures,
                   scene.contacts.notes()};
    page.notes.insert(page.notes.end(), notes.begin(), notes.end());
    write_file(options.out / "pairs.csv", check.pairs_csv);
    write_file(options.out / "clearance.svg", clearance_svg(check, options.margin_mm));
    write_file(options.out / "report.html", check_page(check, page));
    write_file(options.out / "report.json", json);
  }
  if (common.json) fmt::print("{}", json);
  if (!common.quiet) {
    for (const auto& note : scene.contacts.notes()) fmt::print(stderr, "note: {}\n", note);
    for (const auto& note : notes) fmt::print(stderr, "note: {}\n", note);
    fmt::print(stderr, "{}", check.text(options.margin_mm));
  }
  return check.violated() ? violation : 0;
}

}  // namespace condyle
