#include "tools/series_list.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/core/error.h"
#include "engine/dicom/ct_volume.h"

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

/// The default series, or 0 and the reason.
std::pair<int, std::string> default_of(const CtFolder& folder) {
  try {
    return {folder.default_series(false), ""};
  } catch (const InputError& error) {
    return {0, error.what()};
  }
}

Json described(const CtSeries& series) {
  const Eigen::Vector3d extent = series.extent_mm();
  Json json = {
      {"number", series.number},
      {"kind", series_kind_name(series.kind)},
      {"slices", series.slices},
      {"columns", series.columns},
      {"rows", series.rows},
      {"spacing_mm", {series.column_spacing_mm, series.row_spacing_mm, series.step_mm}},
      {"extent_mm", {extent.x(), extent.y(), extent.z()}},
      {"thickness_mm", series.thickness_mm},
      {"tilt_degrees", series.tilt_degrees},
      {"modality", series.modality},
      {"kernel", series.kernel},
      {"kvp", series.kvp},
      {"manufacturer", series.manufacturer},
      {"encoding", series.coding},
      {"readable", series.readable(false)},
      {"readable_resampled", series.readable(true)},
      {"notes", series.notes},
      {"problems", series.problems},
  };
  if (!series.uneven.empty()) json["problems"].push_back(series.uneven);
  return json;
}

std::string facts_of(const CtSeries& series) {
  const Eigen::Vector3d extent = series.extent_mm();
  std::string facts =
      fmt::format("{}, {} slice{} of {} x {}", series_kind_name(series.kind), series.slices,
                  series.slices == 1 ? "" : "s", series.columns, series.rows);
  if (series.step_mm > 0)
    facts += fmt::format(", {:.3g} x {:.3g} x {:.3g} mm apart, {:.0f} x {:.0f} x {:.0f} mm in all",
                         series.column_spacing_mm, series.row_spacing_mm, series.step_mm,
                         extent.x(), extent.y(), extent.z());
  if (!series.kernel.empty()) facts += ", kernel " + series.kernel;
  if (series.kvp > 0) facts += fmt::format(", {:g} kVp", series.kvp);
  if (!series.manufacturer.empty()) facts += ", " + series.manufacturer;
  return facts + ", " + series.coding;
}

}  // namespace

void print_series(const CtFolder& folder, const std::filesystem::path& path,
                  const CommonOptions& common) {
  const auto [chosen, reason] = default_of(folder);
  if (common.json) {
    const CtFileCounts& counts = folder.counts();
    Json json = {{"folder", path.string()}, {"files", counts.files},
                 {"slices", counts.slices}, {"default", chosen == 0 ? Json(nullptr) : Json(chosen)},
                 {"notes", folder.notes()}, {"series", Json::array()}};
    for (const CtSeries& series : folder.series()) json["series"].push_back(described(series));
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
    return;
  }
  fmt::print("{}: {} series\n", path.string(), folder.series().size());
  for (const CtSeries& series : folder.series()) {
    fmt::print("{} {:>2}  {}\n", series.number == chosen ? "*" : " ", series.number,
               facts_of(series));
    for (const std::string& note : series.notes) fmt::print("      note: {}\n", note);
    for (const std::string& problem : series.problems) fmt::print("      refused: {}\n", problem);
    if (!series.uneven.empty()) fmt::print("      refused unless resampled: {}\n", series.uneven);
  }
  for (const std::string& note : folder.notes()) fmt::print("  note: {}\n", note);
  fmt::print("{}\n", chosen > 0 ? "* is taken by default" : reason);
}

bool holds_dicom(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_directory(path, error) || fs::exists(path / "case.json", error)) return false;
  int looked_at = 0;
  for (fs::recursive_directory_iterator entry(path, fs::directory_options::skip_permission_denied,
                                              error);
       !error && entry != fs::recursive_directory_iterator() && looked_at < 1000;
       entry.increment(error), ++looked_at)
    if (entry->is_regular_file(error) && is_dicom_file(entry->path())) return true;
  return false;
}

}  // namespace condyle
