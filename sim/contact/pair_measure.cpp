#include "sim/contact/pair_measure.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "engine/mesh/measure.h"

namespace condyle {
namespace {

constexpr double middle_mm = 5;     // on either side of the midline
constexpr double one_sided = 0.95;  // fraction of the area that makes a contact left or right
// patches farther apart, as of both condyles, are separate contacts
constexpr double together_mm = 70;
constexpr int volume_columns = 256;
// Contacts wider than 1250 mm^2 (overlapping bones) are measured with coarser pieces.
constexpr double max_pieces = 20000;

/// The region of B inside A or near to it.
ContactRegion region_of(const SignedSurface& a, const Pose& X_A, const NearTriangles& b,
                        const Pose& X_B) {
  RegionSettings settings;
  const TriMesh near = b.near(X_B, a, X_A, settings.within_mm);
  settings.resolution_mm =
      std::max(settings.resolution_mm, std::sqrt(surface_area(near) / max_pieces));
  return contact_region(a, X_A, near, X_B, settings);
}

void turn(ContactRegion& region) {
  region.normal = -region.normal;
  for (auto& patch : region.patches) patch.normal = -patch.normal;
}

}  // namespace

struct PairMeasures::PartShape {
  std::once_flag made;
  std::optional<SignedSurface> surface;
  std::optional<NearTriangles> triangles;
  TriMesh closed;
};

PairMeasures::PairMeasures(const Case& patient) : patient_(patient), places_(patient) {
  for (std::size_t i = 0; i < patient.parts.size(); ++i)
    shapes_.push_back(std::make_unique<PartShape>());
}

PairMeasures::~PairMeasures() = default;

const PairMeasures::PartShape& PairMeasures::shape(int part) const {
  PartShape& shape = *shapes_[static_cast<std::size_t>(part)];
  std::call_once(shape.made, [&] {
    const TriMesh& mesh = patient_.parts[static_cast<std::size_t>(part)].mesh;
    shape.surface.emplace(mesh);
    shape.triangles.emplace(mesh);
    shape.closed = closed_shells(mesh);
  });
  return shape;
}

PairMeasure PairMeasures::measure(const PairContact& pair, const BodyPoses& at) const {
  const PartShape &a = shape(pair.part_a), &b = shape(pair.part_b);
  const Pose X_CA = pose_of(patient_.parts[static_cast<std::size_t>(pair.part_a)], at),
             X_CB = pose_of(patient_.parts[static_cast<std::size_t>(pair.part_b)], at);
  PairMeasure measure;
  measure.open_a = a.surface->has_open_shells();
  measure.open_b = b.surface->has_open_shells();
  measure.volume_known = a.surface->has_inside() && b.surface->has_inside();
  measure.place = 0.5 * (pair.witness_a + pair.witness_b);
  Eigen::Vector3d place_a = pair.witness_a, place_b = pair.witness_b;
  ContactRegion region, placed;  // the measured region, and the one that locates the contact
  if (!pair.touching) {
    const Eigen::Vector3d gap = pair.witness_b - pair.witness_a;
    if (gap.norm() > 0) measure.normal = gap.normalized();
  } else {
    region = region_of(*a.surface, X_CA, *b.triangles, X_CB);
    const auto a_in_b = [&] {
      ContactRegion turned = region_of(*b.surface, X_CB, *a.triangles, X_CA);
      turn(turned);
      return turned;
    };
    if (region.patches.empty()) region = a_in_b();  // A lies entirely in B
    // An open surface has no depths to find the deepest point by; it may lie in the other one.
    if (!a.surface->has_inside() && b.surface->has_inside()) placed = a_in_b();
    if (placed.patches.empty()) placed = region;
    measure.area_mm2 = region.area_mm2;
    measure.patches = static_cast<int>(region.patches.size());
    if (measure.volume_known) {
      const auto volume = overlap_volume(a.closed, X_CA, b.closed, X_CB, volume_columns);
      measure.volume_mm3 = volume.mm3;
      measure.volume_error_mm3 = volume.error_mm3;
    }
    const ContactPatch* deepest = nullptr;
    for (const auto& patch : placed.patches)
      if (!deepest || patch.depth_mm > deepest->depth_mm) deepest = &patch;
    if (deepest) {
      measure.place = deepest->deepest;
      if (deepest->normal.norm() > 0.5)
        measure.normal = deepest->normal;
      else if (placed.normal.norm() > 0.5)
        measure.normal = placed.normal;
    }
    place_a = place_b = measure.place;
  }
  Box box, own;  // of all patches, and of the one at the location
  box.add(measure.place);
  own.add(measure.place);
  for (const auto& patch : placed.patches) {
    box.add(patch.box);
    if (patch.deepest == measure.place) own.add(patch.box);
  }
  if (box.size().maxCoeff() > together_mm) box = own;
  measure.middle = box.center();
  measure.size_mm = box.size().maxCoeff();
  measure.side = side_of(region, measure.place);
  measure.region_a = places_.name(pair.part_a, X_CA.inverse() * place_a);
  measure.region_b = places_.name(pair.part_b, X_CB.inverse() * place_b);
  return measure;
}

std::string PairMeasures::side_of(const ContactRegion& region, const Eigen::Vector3d& place) const {
  const double midline_mm = places_.midline_mm();
  double left = 0, right = 0, middle = 0;
  const auto add = [&](const Eigen::Vector3d& p, double area) {
    const double x = p.x() - midline_mm;
    (std::abs(x) < middle_mm ? middle : x > 0 ? left : right) += area;
  };
  for (const auto& patch : region.patches) {
    // A patch over both halves, as of a whole arch, is not in the middle.
    const bool wide = patch.box.low.x() < midline_mm - 2 * middle_mm &&
                      patch.box.high.x() > midline_mm + 2 * middle_mm;
    if (wide) return "both";
    add(patch.centroid, patch.area_mm2);
  }
  if (region.patches.empty()) add(place, 1);
  const double all = left + right + middle;
  if (left >= one_sided * all) return "left";
  if (right >= one_sided * all) return "right";
  return middle >= one_sided * all ? "middle" : "both";
}

}  // namespace condyle
