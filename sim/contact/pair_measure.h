#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/collide/overlap_measure.h"
#include "sim/case/case.h"
#include "sim/contact/anatomical_regions.h"
#include "sim/contact/near_triangles.h"
#include "sim/frame/body_poses.h"
#include "sim/frame/contact_set.h"

namespace condyle {

/// Detailed measurement of one pair at one pose. Points in the cranium's frame, mm.
struct PairMeasure {
  double area_mm2 = 0;  // of B's surface inside A or within 0.1 mm of it
  int patches = 0;
  bool volume_known = false;  // both have an inside
  double volume_mm3 = 0, volume_error_mm3 = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();    // deepest point, or centre of the gap
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // there, unit, from A to B
  std::string side;  // "left", "right", "both", or "middle" (within 5 mm of the midline)
  std::string region_a, region_b;                    // see AnatomicalRegions::name
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // centre of the contact there
  double size_mm = 0;                                // its longest side
  bool open_a = false, open_b = false;  // has open shells: no inside there, distance has no sign

  std::string region() const { return join_regions(region_a, region_b); }
};

/// Measures pairs of a case's parts. Data of a part is prepared at its first use; queries may run
/// on several threads concurrently and are bit-identical.
class PairMeasures {
 public:
  /// The patient must outlive this.
  explicit PairMeasures(const Case& patient);
  ~PairMeasures();

  /// `pair` as found by ContactModel at these poses.
  PairMeasure measure(const PairContact& pair, const BodyPoses& at) const;

  const AnatomicalRegions& places() const { return places_; }

 private:
  struct PartShape;
  const PartShape& shape(int part) const;
  std::string side_of(const ContactRegion& region, const Eigen::Vector3d& place) const;

  const Case& patient_;
  AnatomicalRegions places_;
  std::vector<std::unique_ptr<PartShape>> shapes_;
};

}  // namespace condyle
