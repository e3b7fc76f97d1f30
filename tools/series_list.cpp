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
               series_facts(series));
    for (const std::string& note : series.notes) fmt::print("      note: {}\n", note);
    for (const std::string& problem : series.problems) fmt::print("      refused: {}\n", problem);
    if (!series.uneven.empty()) fmt::print("      refused unless resampled: {}\n", series.uneven);
  }
  for (const std::string& note : folder.notes()) fmt::print("  note: {}\n", note);
  fmt::print("{}\n", chosen > 0 ? "* is taken by default" : reason);
}

}  // namespace condyle
