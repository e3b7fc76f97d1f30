#include "sim/report/close_look.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

constexpr double middle_mm = 5;     // to either side of the midline
constexpr double one_sided = 0.95;  // share of the area that makes a contact left or right
constexpr double landmark_mm = 15;  // how near a landmark names a place
constexpr double together_mm = 70;  // patches farther apart, as of both condyles, are not one place
constexpr double tooth_mm = 3;      // how near a tooth does

/// Landmarks that name a region of bone; others are points of muscles, models and measurement.
constexpr std::array region_words = {"condyl", "coronoid",  "gonion",    "notch",    "foramen",
                                     "incis",  "pogonion",  "menton",    "eminence", "fossa",
                                     "zyg",    "prosthion", "infradent", "mastoid"};

bool names_a_region(const std::string& landmark) {
  return std::any_of(region_words.begin(), region_words.end(),
                     [&](const char* word) { return landmark.find(word) != std::string::npos; });
}

/// The separate tooth of a part that lies nearest to the point, 0 when none is near. The part's own
/// coordinates.
int tooth_at(const Part& part, const Eigen::Vector3d& p) {
  double nearest = tooth_mm;
  int fdi = 0;
  for (const auto& tooth : part.teeth)
    for (int t = tooth.first_triangle; t < tooth.first_triangle + tooth.triangle_count; ++t)
      for (const int v : part.mesh.triangles[static_cast<std::size_t>(t)])
        if (const double d = (part.mesh.vertices[v] - p).norm(); d < nearest) {
          nearest = d;
          fdi = tooth.fdi;
        }
  return fdi;
}

/// Half way between the condyles, else the middle of the mandible.
double midline_of(const Case& patient) {
  const auto left = patient.landmarks.find("left_condyle"),
             right = patient.landmarks.find("right_condyle");
  if (left && right) return 0.5 * (left->x() + right->x());
  const Part* mandible = patient.find(Role::mandible);
  return mandible && !mandible->mesh.empty() ? bounding_box(mandible->mesh).center().x() : 0;
}

}  // namespace

CloseLook::CloseLook(const Case& patient) : patient_(patient), midline_mm_(midline_of(patient)) {}

const SignedSurface& CloseLook::surface(int part) {
  auto& kept = surfaces_[part];
  if (!kept)
    kept = std::make_unique<SignedSurface>(patient_.parts[static_cast<std::size_t>(part)].mesh);
  return *kept;
}

const TriMesh& CloseLook::closed(int part) {
  const auto [it, made] = closed_.try_emplace(part);
  if (made) it->second = closed_shells(patient_.parts[static_cast<std::size_t>(part)].mesh);
  return it->second;
}

PairDetail CloseLook::look(const PairContact& pair, const Pose& X_CM) {
  const SignedSurface &a = surface(pair.part_a), &b = surface(pair.part_b);
  PairDetail detail;
  detail.open_a = a.has_open_shells();
  detail.open_b = b.has_open_shells();
  detail.volume_known = a.has_inside() && b.has_inside();
  detail.place = 0.5 * (pair.witness_a + pair.witness_b);
  ContactRegion region, placed;  // what is measured, and where it is looked at
  if (!pair.touching) {
    const Eigen::Vector3d gap = pair.witness_b - pair.witness_a;
    if (gap.norm() > 0) detail.normal = gap.normalized();
  } else {
    const auto& mesh_b = patient_.parts[static_cast<std::size_t>(pair.part_b)].mesh;
    region = contact_region(a, Pose{}, mesh_b, X_CM);
    const auto a_in_b = [&] {
      const auto& mesh_a = patient_.parts[static_cast<std::size_t>(pair.part_a)].mesh;
      ContactRegion turned = contact_region(b, X_CM, mesh_a, Pose{});
      turned.normal = -turned.normal;
      for (auto& patch : turned.patches) patch.normal = -patch.normal;
      return turned;
    };
    if (region.patches.empty()) region = a_in_b();  // A lies wholly in B
    // An open surface has no depths to find the deepest place by; it may lie in the other one.
    if (!a.has_inside() && b.has_inside()) placed = a_in_b();
    if (placed.patches.empty()) placed = region;
    detail.area_mm2 = region.area_mm2;
    detail.patches = static_cast<int>(region.patches.size());
    if (detail.volume_known) {
      const auto volume = overlap_volume(closed(pair.part_a), Pose{}, closed(pair.part_b), X_CM);
      detail.volume_mm3 = volume.mm3;
      detail.volume_error_mm3 = volume.error_mm3;
    }
    const ContactPatch* deepest = nullptr;
    for (const auto& patch : placed.patches)
      if (!deepest || patch.depth_mm > deepest->depth_mm) deepest = &patch;
    if (deepest) {
      detail.place = deepest->deepest;
      if (deepest->normal.norm() > 0.5)
        detail.normal = deepest->normal;
      else if (placed.normal.norm() > 0.5)
        detail.normal = placed.normal;
    }
  }
  Box box, own;  // of all patches, of the one at the place
  box.add(detail.place);
  own.add(detail.place);
  for (const auto& patch : placed.patches) {
    box.add(patch.box);
    if (patch.deepest == detail.place) own.add(patch.box);
  }
  if (box.size().maxCoeff() > together_mm) box = own;
  detail.middle = box.center();
  detail.size_mm = box.size().maxCoeff();
  detail.side = side_of(region, detail.place);
  detail.region = region_of(pair, detail.place, X_CM);
  return detail;
}

std::string CloseLook::side_of(const ContactRegion& region, const Eigen::Vector3d& place) const {
  double left = 0, right = 0, middle = 0;
  const auto add = [&](const Eigen::Vector3d& p, double area) {
    const double x = p.x() - midline_mm_;
    (std::abs(x) < middle_mm ? middle : x > 0 ? left : right) += area;
  };
  for (const auto& patch : region.patches) {
    // A patch over both halves, as of a whole arch, is not in the middle.
    const bool wide = patch.box.low.x() < midline_mm_ - 2 * middle_mm &&
                      patch.box.high.x() > midline_mm_ + 2 * middle_mm;
    if (wide) return "both";
    add(patch.centroid, patch.area_mm2);
  }
  if (region.patches.empty()) add(place, 1);
  const double all = left + right + middle;
  if (left >= one_sided * all) return "left";
  if (right >= one_sided * all) return "right";
  return middle >= one_sided * all ? "middle" : "both";
}

std::string CloseLook::region_of(const PairContact& pair, const Eigen::Vector3d& place,
                                 const Pose& X_CM) const {
  const Eigen::Vector3d in_b = X_CM.inverse() * place;
  const int upper = tooth_at(patient_.parts[static_cast<std::size_t>(pair.part_a)], place),
            lower = tooth_at(patient_.parts[static_cast<std::size_t>(pair.part_b)], in_b);
  if (upper && lower) return fmt::format("teeth {} and {}", upper, lower);
  if (upper || lower) return fmt::format("tooth {}", upper + lower);
  double nearest = landmark_mm;
  std::string name;
  for (const auto& [landmark, point] : patient_.landmarks.points) {
    // Told at rest: those of the mandible have moved with it, those of the cranium have not.
    const double distance = std::min((point - in_b).norm(), (point - place).norm());
    if (distance >= nearest || !names_a_region(landmark)) continue;
    nearest = distance;
    name = landmark;
  }
  if (name.empty()) return "";
  std::replace(name.begin(), name.end(), '_', ' ');
  return "near " + name;
}

}  // namespace condyle
