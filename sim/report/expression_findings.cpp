#include "sim/report/expression_findings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "engine/core/units.h"
#include "sim/muscles/expression_names.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double upper_lip_mm = 1;  // above the line between the lips: on the upper one

struct FacePoint {
  Vector3d rest = Vector3d::Zero(), now = Vector3d::Zero();
  Vector3d moved() const { return now - rest; }
};

bool is_full_smile(std::span<const double> excitation, std::span<const FaceMuscle> muscles) {
  const ExpressionLevel full{.name = "smile", .left = 1, .right = 1};
  const std::vector<double> smile = excitation_of({&full, 1}, muscles);
  return std::equal(smile.begin(), smile.end(), excitation.begin(), excitation.end(),
                    [](double a, double b) { return std::abs(a - b) < 1e-6; });
}

}  // namespace

std::vector<Finding> expression_findings(const Scene& scene, const TissueState& tissue) {
  std::vector<Finding> list;
  if (!scene.tissue || tissue.excitation.empty()) return list;
  const auto& muscles = face_muscles_of(*scene.tissue);
  const bool smile = is_full_smile(tissue.excitation, muscles);
  const auto add = [&](const std::string& name, const char* unit, double value, double low,
                       double high, const char* published) {
    list.push_back({.name = name,
                    .unit = unit,
                    .value = value,
                    .low = smile ? low : 1,
                    .high = smile ? high : 0,
                    .published = smile ? published : "",
                    .input = true});  // forces and attachments were chosen for such values
  };
  const TissueState at_rest = rest_tissue(*scene.tissue);
  const auto point = [&](const char* name, double above_mm = 0) -> std::optional<FacePoint> {
    const auto mark = scene.patient.landmarks.find(name);
    if (!mark) return std::nullopt;
    const Vector3d at = *mark + above_mm * Vector3d::UnitZ();
    return FacePoint{carried_point(*scene.tissue, at_rest, at),
                     carried_point(*scene.tissue, tissue, at)};
  };
  const auto left = point("left_cheilion"), right = point("right_cheilion");
  if (!left || !right) return list;
  const std::array<std::pair<const char*, Vector3d>, 2> corners = {
      {{"left", left->moved()},
       {"right", Vector3d(right->moved().cwiseProduct(Vector3d(-1, 1, 1)))}}};
  for (const auto& [side, moved] : corners) {
    const std::string corner = std::string(side) + " corner of the mouth";
    add(corner + ": displacement", "mm", moved.norm(), 9, 14, "9.3 +- 2.8; 11 to 14");
    add(corner + ": direction above the horizontal, frontal", "deg",
        std::atan2(moved.z(), moved.x()) * degrees_per_radian, 35, 60, "47");
  }
  add("asymmetry of the corners' displacement", "mm",
      (corners[0].second - corners[1].second).norm(), 0, 3, "0.5 to 2.3");
  const double width = (left->rest - right->rest).norm();
  add("change of the mouth's width", "%", 100 * ((left->now - right->now).norm() / width - 1), 20,
      35, "27");
  const auto nose = point("subnasale"), red = point("labrale_superius"),
             margin = point("stomion", upper_lip_mm);
  const auto change_of_height = [&](const FacePoint& lip) {
    return 100 * ((nose->now.z() - lip.now.z()) / (nose->rest.z() - lip.rest.z()) - 1);
  };
  if (nose && margin)
    add("change of the upper lip's length", "%", change_of_height(*margin), -32, -20, "-23 to -30");
  if (nose && red)
    add("change of the upper lip's skin, subnasale to labrale superius", "%",
        change_of_height(*red), 1, 0, "");
  const auto length = face_muscle_lengths(*scene.tissue, tissue),
             rest_length = face_muscle_lengths(*scene.tissue, at_rest);
  for (std::size_t m = 0; m < muscles.size(); ++m)
    if (muscles[m].kind == "zygomaticus_major")
      add(muscles[m].name + ": length over that at rest", "", length[m] / rest_length[m], 0.82,
          0.89, "0.856");
  return list;
}

}  // namespace condyle
