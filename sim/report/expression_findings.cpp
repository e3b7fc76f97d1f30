#include "sim/report/expression_findings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "engine/core/units.h"
#include "sim/case/eyes.h"
#include "sim/muscles/expression_names.h"
#include "sim/tissue/model.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

struct FacePoint {
  Vector3d rest = Vector3d::Zero(), now = Vector3d::Zero();
  Vector3d moved() const { return now - rest; }
};

/// Whether the excitation is that of expressions at full strength on both sides.
bool is_full(std::initializer_list<const char*> names, std::span<const double> excitation,
             std::span<const FaceMuscle> muscles) {
  std::vector<ExpressionLevel> full;
  for (const char* name : names) full.push_back({.name = name, .left = 1, .right = 1});
  const std::vector<double> smile = excitation_of(full, muscles).muscles;
  return std::equal(smile.begin(), smile.end(), excitation.begin(), excitation.end(),
                    [](double a, double b) { return std::abs(a - b) < 1e-6; });
}

/// Collects findings; ranges count for the full expression alone that they are of.
struct Collected {
  std::vector<Finding> list;
  bool smile = false, brows_lifted = false, frown = false;

  void add(const std::string& name, const char* unit, double value, double low = 1, double high = 0,
           const char* published = "", bool input = true, const char* why = "") {
    add_for(smile, name, unit, value, low, high, published, input, why);
  }
  void add_for(bool full, const std::string& name, const char* unit, double value, double low,
               double high, const char* published, bool input = true, const char* why = "") {
    list.push_back({.name = name,
                    .unit = unit,
                    .value = value,
                    .low = full ? low : 1,
                    .high = full ? high : 0,
                    .published = full ? published : "",
                    .input = input,
                    .why = why});
  }
};

void add_corners(const FacePoint& left, const FacePoint& right, Collected& to) {
  const std::array<std::pair<const char*, Vector3d>, 2> corners = {
      {{"left", left.moved()},
       {"right", Vector3d(right.moved().cwiseProduct(Vector3d(-1, 1, 1)))}}};
  for (const auto& [side, moved] : corners) {
    const std::string corner = std::string(side) + " corner of the mouth";
    to.add(corner + ": displacement", "mm", moved.norm(), 9, 14, "9.3 +- 2.8; 11 to 14");
    to.add(corner + ": direction above the horizontal, frontal", "deg",
           std::atan2(moved.z(), moved.x()) * degrees_per_radian, 35, 60, "47");
    to.add(corner + ": displacement outward", "mm", moved.x());
    to.add(corner + ": displacement backward", "mm", moved.y());
    to.add(corner + ": displacement upward", "mm", moved.z());
  }
  to.add("asymmetry of the corners' displacement", "mm",
         (corners[0].second - corners[1].second).norm(), 0, 3, "0.5 to 2.3");
  const double a = corners[0].second.norm(), b = corners[1].second.norm();
  if (const double more = std::max(a, b); more > 0)
    to.add("asymmetry index: difference of the corners' displacements over the larger", "%",
           100 * std::abs(a - b) / more);
  to.add("change of the mouth's width", "%",
         100 * ((left.now - right.now).norm() / (left.rest - right.rest).norm() - 1), 20, 35, "27");
}

/// The brows' middles above the line between the canthi, and their inner ends. They are fitted,
/// too.
void add_brows(const Eyes& eyes, const auto& point_at, Collected& to) {
  const Vector3d above_eye(0, -9, 21);
  for (const auto& [side, eye] : {std::pair("left", &eyes.left), std::pair("right", &eyes.right)}) {
    const double sign = eye == &eyes.left ? 1 : -1;
    const std::string name = std::string(side) + " brow";
    const Vector3d middle = point_at(0.5 * (eye->inner + eye->outer) + above_eye).moved(),
                   inner = point_at(eye->inner + above_eye + sign * Vector3d(3, 0, 0)).moved();
    to.add_for(to.brows_lifted, name + ": displacement upward", "mm", middle.z(), 8.1, 13.1,
               "10.6 +- 2.5");
    to.add_for(to.frown, name + ", inner end: displacement", "mm", inner.norm(), 4.3, 10.9,
               "7.6 +- 3.3");
    to.add(name + ", inner end: displacement inward", "mm", -sign * inner.x());
    to.add(name + ", inner end: displacement upward", "mm", inner.z());
  }
}

/// From the lower margin of the orbit to the skin of the cheek before it.
const Vector3d below_orbit(0, -6, -12);

/// What the lips show of the upper teeth.
void add_teeth(const SmileMeasures& at_rest, const SmileMeasures& now, Collected& to) {
  constexpr const char* why = "the rise of this lip, or the height of lip and teeth at rest";
  if (at_rest.incisor_show_mm)
    to.add("upper incisor show at rest", "mm", *at_rest.incisor_show_mm, 1, 0,
           "2 to 5 with relaxed, parted lips", false);
  if (now.incisor_show_mm)
    to.add("upper incisor show", "mm", *now.incisor_show_mm, 1, 0, "", false);
  if (now.crown_fraction)
    to.add("upper incisor show over the crown", "%", 100 * *now.crown_fraction, 75, 100,
           "75 to 100", false, why);
  if (now.gum_show_mm)
    to.add("gum show above the upper incisors", "mm", *now.gum_show_mm, 0, 2,
           "1 to 2 accepted, over 3 to 4 gummy", false, why);
  if (now.buccal_corridor)
    to.add("buccal corridor, both sides, over the mouth's width", "%", 100 * *now.buccal_corridor,
           1, 0, "", false);
}

/// Margins of the lips at rest and now; none without an opening between them.
struct MarginsOfLips {
  LipMargins rest, now;
};
std::optional<MarginsOfLips> margins_of_lips(const Scene& scene, const TissueState& at_rest,
                                             const TissueState& tissue) {
  const Part* face = scene.patient.find(Role::face);
  const auto upper = scene.patient.landmarks.find("upper_incisal_point"),
             lower = scene.patient.landmarks.find("lower_incisal_point");
  if (!face || !upper || !lower) return std::nullopt;
  const MouthOutline mouth =
      find_mouth(face->mesh, scene.patient.landmarks, 0.5 * (*upper + *lower));
  if (!mouth.found()) return std::nullopt;
  const LipSurfaces lips = lip_surfaces(face->mesh, mouth);
  if (lips.upper.empty() || lips.lower.empty()) return std::nullopt;
  const auto margins = [&](const TissueState& state) {
    std::vector<Eigen::Vector3f> vertices;
    deform_face(*scene.tissue, state, vertices);
    return lip_margins(lips, vertices);
  };
  MarginsOfLips both{margins(at_rest), margins(tissue)};
  if (both.rest.left_x <= both.rest.right_x || both.now.left_x <= both.now.right_x)
    return std::nullopt;
  return both;
}

}  // namespace

ExpressionMeasures expression_measures(const Scene& scene, const TissueState& tissue) {
  ExpressionMeasures measures;
  if (!scene.tissue || tissue.excitation.empty()) return measures;
  const auto& muscles = face_muscles_of(*scene.tissue);
  Collected found{.list = {},
                  .smile = is_full({"smile"}, tissue.excitation, muscles),
                  .brows_lifted = is_full({"surprise"}, tissue.excitation, muscles),
                  .frown = is_full({"AU4"}, tissue.excitation, muscles)};
  const TissueState at_rest = rest_tissue(*scene.tissue);
  const auto point = [&](const std::string& name,
                         const Vector3d& offset = Vector3d::Zero()) -> std::optional<FacePoint> {
    const auto mark = scene.patient.landmarks.find(name);
    if (!mark) return std::nullopt;
    return FacePoint{carried_point(*scene.tissue, at_rest, *mark + offset),
                     carried_point(*scene.tissue, tissue, *mark + offset)};
  };
  const auto left = point("left_cheilion"), right = point("right_cheilion");
  if (!left || !right) return measures;
  add_corners(*left, *right, found);
  const auto nose = point("subnasale"), red = point("labrale_superius");
  const auto lips = margins_of_lips(scene, at_rest, tissue);
  const auto change_below_nose = [&](double rest_z, double now_z) {
    return 100 * ((nose->now.z() - now_z) / (nose->rest.z() - rest_z) - 1);
  };
  if (nose && lips)
    found.add(
        "change of the upper lip's length", "%",
        change_below_nose(lips->rest.upper_at(nose->rest.x()), lips->now.upper_at(nose->now.x())),
        -32, -20, "-23 to -30");
  if (nose && red)
    found.add("change of the upper lip's skin, subnasale to labrale superius", "%",
              change_below_nose(red->rest.z(), red->now.z()));
  for (const auto& [lip, mark] :
       {std::pair("upper", "labrale_superius"), std::pair("lower", "labrale_inferius")})
    if (const auto at = point(mark)) {
      found.add(std::string(lip) + " lip: displacement forward", "mm", -at->moved().y());
      found.add(std::string(lip) + " lip: displacement upward", "mm", at->moved().z());
    }
  for (const std::string side : {"left", "right"})
    if (const auto cheek = point(side + "_orbitale", below_orbit))
      found.add(side + " cheek below the orbit: displacement upward", "mm", cheek->moved().z());
  const Part* face = scene.patient.find(Role::face);
  const auto eyes = face && scene.tissue->display->region.upper_face
                        ? find_eyes(face->mesh, scene.patient.landmarks)
                        : std::nullopt;
  if (eyes)
    add_brows(
        *eyes,
        [&](const Vector3d& at) {
          return FacePoint{carried_point(*scene.tissue, at_rest, at),
                           carried_point(*scene.tissue, tissue, at)};
        },
        found);
  const auto length = face_muscle_lengths(*scene.tissue, tissue),
             rest_length = face_muscle_lengths(*scene.tissue, at_rest);
  for (std::size_t m = 0; m < muscles.size(); ++m)
    if (muscles[m].kind == "zygomaticus_major")
      found.add(muscles[m].name + ": length over that at rest", "", length[m] / rest_length[m],
                0.82, 0.89, "0.856");
  if (lips) {
    measures.at_rest = smile_measures(scene.patient, lips->rest, at_rest.X_CB);
    measures.now = smile_measures(scene.patient, lips->now, tissue.X_CB);
  }
  add_teeth(measures.at_rest, measures.now, found);
  measures.findings = std::move(found.list);
  return measures;
}

}  // namespace condyle
