#include "sim/comparison/face_comparison_text.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "sim/plan/columns.h"

namespace condyle {
namespace {

double degrees_of(const Pose& pose) { return rotation_angle(pose) * 180 / std::numbers::pi; }

std::string registration_text(const FaceComparison& comparison) {
  if (comparison.registration_points == 0) return "as delivered, without registration";
  return fmt::format(
      "registered on {} points of the upper face, {:.2f} mm RMS (turned by {:.2f} degrees, shifted "
      "by {:.2f} mm)",
      comparison.registration_points, comparison.registration_rms_mm, degrees_of(comparison.X_PO),
      comparison.X_PO.t.norm());
}

}  // namespace

std::string face_comparison_text(const FaceComparison& comparison) {
  std::vector<std::vector<std::string>> rows = {{"distance, mm", "mean", "median", "p90", "p95",
                                                 "max", "below 2 mm", "signed mean",
                                                 "signed median", "measured"}};
  const auto mm = [](double value) { return fmt::format("{:.2f}", value); };
  const auto with_sign = [](double value) {
    return fmt::format("{:+.2f}", std::abs(value) < 0.005 ? 0.0 : value);
  };
  const auto percent = [](double share) { return fmt::format("{:.0f} %", 100 * share); };
  for (const RegionDistances& row : comparison.rows)
    rows.push_back({row.region, mm(row.mean_mm), mm(row.median_mm), mm(row.p90_mm), mm(row.p95_mm),
                    mm(row.max_mm), percent(row.share_below_2_mm), with_sign(row.signed_mean_mm),
                    with_sign(row.signed_median_mm), percent(row.measured_share)});
  return fmt::format(
      "{}\n{}Signed: positive where the prediction lies in front of the face after the operation.\n"
      "Measured: share of the region's area with a partner there.{}\n",
      registration_text(comparison), aligned_columns(rows, "lrrrrrrrrr"),
      comparison.regions.empty() ? "" : " Whole: all regions but the upper face.");
}

nlohmann::ordered_json face_comparison_json(const FaceComparison& comparison) {
  const Pose& X_PO = comparison.X_PO;
  nlohmann::ordered_json json = {
      {"registration",
       {{"points", comparison.registration_points},
        {"rms_mm", comparison.registration_rms_mm},
        {"turned_deg", degrees_of(X_PO)},
        {"quaternion_wxyz", {X_PO.R.w(), X_PO.R.x(), X_PO.R.y(), X_PO.R.z()}},
        {"translation_mm", {X_PO.t.x(), X_PO.t.y(), X_PO.t.z()}}}},
      {"regions", nlohmann::ordered_json::array()},
      {"notes", comparison.notes}};
  for (const RegionDistances& row : comparison.rows)
    json["regions"].push_back({{"region", row.region},
                               {"points", row.points},
                               {"area_mm2", row.area_mm2},
                               {"measured_share", row.measured_share},
                               {"mean_mm", row.mean_mm},
                               {"median_mm", row.median_mm},
                               {"p90_mm", row.p90_mm},
                               {"p95_mm", row.p95_mm},
                               {"max_mm", row.max_mm},
                               {"share_below_2_mm", row.share_below_2_mm},
                               {"signed_mean_mm", row.signed_mean_mm},
                               {"signed_median_mm", row.signed_median_mm}});
  return json;
}

std::string face_comparison_csv(const FaceComparison& comparison, const TriMesh& predicted) {
  std::string text = "vertex,x_mm,y_mm,z_mm,region,distance_mm\n";
  for (std::size_t i = 0; i < comparison.distance_mm.size(); ++i) {
    const Eigen::Vector3d& p = predicted.vertices[i];
    const double distance = comparison.distance_mm[i];
    text += fmt::format("{},{:.4f},{:.4f},{:.4f},{},{}\n", i, p.x(), p.y(), p.z(),
                        comparison.regions.empty() ? "" : region_name(comparison.regions[i]),
                        std::isfinite(distance) ? fmt::format("{:.4f}", distance) : "");
  }
  return text;
}

}  // namespace condyle
