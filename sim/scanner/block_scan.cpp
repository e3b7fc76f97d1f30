#include "sim/scanner/block_scan.h"

#include <algorithm>
#include <cmath>

namespace condyle {
namespace {

using Eigen::Vector3d;

// Thicknesses, mm.
constexpr double cortex = 1.8, dermis = 2, fat = 5, enamel = 1.2;
constexpr double nose_cover = 3;  // the cavity as cut from bone would open a box through the nose
// Hounsfield units.
constexpr double air_hu = -1000, skin_hu = 20, fat_hu = -90, muscle_hu = 55, tongue_hu = 50,
                 gum_hu = 40, cortex_hu = 1300, marrow_hu = 450, dentine_hu = 1600,
                 enamel_hu = 2400;
constexpr double upper_neck_z = -42.5, lower_neck_z = -58;  // crowns of the built-in patient, mm

/// One block: tissues are laid over each other, each by the part of the voxel that it covers.
class BlockPainter {
 public:
  BlockPainter(const ScannedHead& head, const CtSettings& settings,
               const std::vector<Vector3d>& points, const std::array<int, 3>& size, double voxel_mm)
      : head_(head),
        settings_(settings),
        voxel_mm_(voxel_mm),
        skull_(places(HeadMap::skull, points, size)),
        mandible_(head.is_reshaped() ? places(HeadMap::mandible, points, size) : skull_),
        skin_(places(HeadMap::skin, points, size)) {
    scan_.hu.assign(points.size(), static_cast<float>(air_hu));
    scan_.tissue.assign(points.size(), ScanTissue::outside);
  }

  BlockScan take() {
    const PhantomSolid& solid = head_.solid();
    if (paint_skin()) {
      paint(solid.oral_cavity, skin_, air_hu, ScanTissue::cavity);
      paint_nose();
      paint(solid.tongue, mandible_, tongue_hu, ScanTissue::soft);
      paint(solid.upper_gums, skull_, gum_hu, ScanTissue::soft);
      paint(solid.lower_gums, mandible_, gum_hu, ScanTissue::soft);
    }
    paint_bone(solid.skull, skull_, ScanTissue::skull);
    paint_bone(solid.mandible, mandible_, ScanTissue::mandible);
    paint_teeth();
    return std::move(scan_);
  }

 private:
  BlockPlaces places(HeadMap map, const std::vector<Vector3d>& points,
                     const std::array<int, 3>& size) const {
    std::vector<Vector3d> there = points;
    for (auto& p : there) p = head_.standard_place(map, p);
    return {std::move(there), size};
  }
  /// The part of a voxel that lies inside, by the distance at its centre.
  double coverage(double d) const { return std::clamp(0.5 - d / voxel_mm_, 0.0, 1.0); }
  void mix(std::size_t q, double covered, double hu, ScanTissue tissue) {
    if (covered <= 0) return;
    scan_.hu[q] = static_cast<float>(scan_.hu[q] + (hu - scan_.hu[q]) * covered);
    if (covered > 0.5) scan_.tissue[q] = tissue;
  }

  bool paint_skin() {
    if (!sample_block(head_.solid().skin, skin_, dermis + fat + voxel_mm_, skin_depth_))
      return false;
    for (std::size_t q = 0; q < skin_depth_.size(); ++q) {
      const double d = skin_depth_[q];
      const double hu = d > -dermis ? skin_hu : d > -fat ? fat_hu : muscle_hu;
      mix(q, coverage(d), hu, ScanTissue::soft);
    }
    return true;
  }
  void paint(const FieldRecipe& recipe, const BlockPlaces& block, double hu, ScanTissue tissue) {
    if (!sample_block(recipe, block, voxel_mm_, values_)) return;
    for (std::size_t q = 0; q < values_.size(); ++q) mix(q, coverage(values_[q]), hu, tissue);
  }
  void paint_nose() {
    if (!sample_block(head_.solid().nasal_cavity, skull_, voxel_mm_, values_)) return;
    for (std::size_t q = 0; q < values_.size(); ++q)
      mix(q, coverage(std::max<double>(values_[q], skin_depth_[q] + nose_cover)), air_hu,
          ScanTissue::cavity);
  }
  double marrow(const Vector3d& p) const {
    if (!settings_.dark_marrow) return marrow_hu;
    return 150 +
           100 * std::sin(0.9 * p.x()) * std::sin(0.8 * p.y() + 1) * std::sin(0.7 * p.z() + 2);
  }
  void paint_bone(const FieldRecipe& recipe, const BlockPlaces& block, ScanTissue tissue) {
    if (!sample_block(recipe, block, cortex + voxel_mm_, values_)) return;
    for (std::size_t q = 0; q < values_.size(); ++q) {
      const double d = values_[q], inner = coverage(d + cortex);
      mix(q, coverage(d), cortex_hu + (marrow(block.points[q]) - cortex_hu) * inner, tissue);
    }
  }
  void paint_teeth() {
    deepest_.assign(scan_.hu.size(), 0);
    const BlockPlaces upper_twin = skull_.mirrored_x();
    const BlockPlaces lower_twin = head_.is_reshaped() ? mandible_.mirrored_x() : upper_twin;
    for (const ToothSolid& tooth : head_.solid().teeth) {
      const bool upper = tooth.fdi < 30;
      paint_tooth(tooth, upper, upper ? skull_ : mandible_);
      paint_tooth(tooth, upper, upper ? upper_twin : lower_twin);
    }
  }
  void paint_tooth(const ToothSolid& tooth, bool upper, const BlockPlaces& block) {
    Eigen::AlignedBox3d reach = tooth.box;
    const Vector3d margin = Vector3d::Constant(2 * voxel_mm_ + head_.tooth_growth_mm());
    reach.min() -= margin;
    reach.max() += margin;
    if (!reach.intersects(block.box)) return;
    const double growth = head_.tooth_growth_mm();
    if (!sample_block(tooth.solid, block, enamel + voxel_mm_ + growth, values_)) return;
    for (std::size_t q = 0; q < values_.size(); ++q) {
      const double d = values_[q] - growth, z = block.points[q].z();
      if (!reach.contains(block.points[q])) continue;
      const bool crown = upper ? z < upper_neck_z : z > lower_neck_z;
      const double inner = crown ? coverage(d + enamel) : 1;
      const double hu = enamel_hu + (dentine_hu - enamel_hu) * inner;
      const ScanTissue before = scan_.tissue[q];
      mix(q, coverage(d), hu, upper ? ScanTissue::upper_teeth : ScanTissue::lower_teeth);
      if (d < deepest_[q])
        deepest_[q] = static_cast<float>(d);  // where teeth overlap, the deepest one has the voxel
      else
        scan_.tissue[q] = before;
    }
  }

  const ScannedHead& head_;
  const CtSettings& settings_;
  double voxel_mm_;
  BlockPlaces skull_, mandible_, skin_;
  BlockScan scan_;
  std::vector<float> values_, skin_depth_, deepest_;
};

}  // namespace

BlockScan scan_block(const ScannedHead& head, const CtSettings& settings,
                     const std::vector<Vector3d>& points, const std::array<int, 3>& size,
                     double voxel_mm) {
  return BlockPainter(head, settings, points, size, voxel_mm).take();
}

}  // namespace condyle
