#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/collide/overlap_measure.h"
#include "sim/case/case.h"
#include "sim/contact/near_triangles.h"
#include "sim/contact/places.h"
#include "sim/frame/body_poses.h"
#include "sim/frame/contact_set.h"

namespace condyle {

/// One pair at one pose, measured closely. Points in the cranium's frame, mm.
struct PairMeasure {
  double area_mm2 = 0;  // of B's surface inside A or within 0.1 mm of it
  int patches = 0;
  bool volume_known = false;  // both have an inside
  double volume_mm3 = 0, volume_error_mm3 = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();    // deepest point, or middle of the gap
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // there, unit, from A to B
  std::string side;  // "left", "right", "both", or "middle" (within 5 mm of the midline)
  std::string region_a, region_b;                    // see Places::name
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // of the contact there
  double size_mm = 0;                                // its longest side
  bool open_a = false, open_b = false;  // has open shells: no inside there, distance has no sign

  std::string region() const { return both_places(region_a, region_b); }
};

/// Measures pairs of a case's parts. What it needs of a part is made when that part is first asked
/// for; queries may run on several threads at once and have the same bits.
class PairMeasures {
 public:
  /// The patient must outlive this.
  explicit PairMeasures(const Case& patient);
  ~PairMeasures();

  /// `pair` as ContactModel found it at these poses.
  PairMeasure measure(const PairContact& pair, const BodyPoses& at) const;

  const Places& places() const { return places_; }

 private:
  struct PartShape;
  const PartShape& shape(int part) const;
  std::string side_of(const ContactRegion& region, const Eigen::Vector3d& place) const;

  const Case& patient_;
  Places places_;
  std::vector<std::unique_ptr<PartShape>> shapes_;
};

}  // namespace condyle
