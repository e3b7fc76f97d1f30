#pragma once

#include <map>
#include <memory>
#include <string>

#include "engine/collide/overlap_measure.h"
#include "sim/case/case.h"
#include "sim/frame/contact_set.h"

namespace condyle {

/// One pair at one frame, measured closely. Points in the cranium's frame, mm.
struct PairDetail {
  double area_mm2 = 0;  // of B's surface inside A or within 0.1 mm of it
  int patches = 0;
  bool volume_known = false;  // both have an inside
  double volume_mm3 = 0, volume_error_mm3 = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();    // deepest point, or middle of the gap
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // there, unit, from A to B
  std::string side;    // "left", "right", "both", or "middle" (within 5 mm of the midline)
  std::string region;  // "teeth 26 and 36", "near left condyle", or empty
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // of the contact there
  double size_mm = 0;                                // its longest side
  bool open_a = false, open_b = false;  // has open shells: no inside there, distance has no sign
};

/// Keeps what the close measures need of each part, made when first asked for.
class CloseLook {
 public:
  /// The patient must outlive this.
  explicit CloseLook(const Case& patient);

  PairDetail look(const PairContact& pair, const Pose& X_CM);

  const SignedSurface& surface(int part);

 private:
  const TriMesh& closed(int part);
  std::string side_of(const ContactRegion& region, const Eigen::Vector3d& place) const;
  std::string region_of(const PairContact& pair, const Eigen::Vector3d& place,
                        const Pose& X_CM) const;

  const Case& patient_;
  double midline_mm_ = 0;  // x
  std::map<int, std::unique_ptr<SignedSurface>> surfaces_;
  std::map<int, TriMesh> closed_;
};

}  // namespace condyle
