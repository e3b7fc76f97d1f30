#pragma once

#include <memory>
#include <vector>

#include "sim/phantom/head_shape.h"
#include "sim/phantom/phantom_solid.h"

namespace condyle {

class HeadWarp;

/// Which motion a solid follows when the head is given another shape.
enum class HeadMap { skull, mandible, skin };

/// A built-in head that can be scanned: the solids of the built-in patient, and the map from the
/// places of this head to those of the built-in patient.
class ScannedHead {
 public:
  /// `tooth_growth_mm`: crowns and roots are thicker by it; above 0.05 opposing teeth touch.
  explicit ScannedHead(const HeadChoice& choice = {}, double tooth_growth_mm = 0);
  ~ScannedHead();
  ScannedHead(ScannedHead&&) noexcept;
  ScannedHead& operator=(ScannedHead&&) noexcept;

  const PhantomSolid& solid() const { return solid_; }
  double tooth_growth_mm() const { return tooth_growth_mm_; }
  /// The place in the built-in patient of a place in this head, mm.
  Eigen::Vector3d standard_place(HeadMap map, const Eigen::Vector3d& p) const;
  /// The place in this head of a place in the built-in patient, mm.
  Eigen::Vector3d place(HeadMap map, const Eigen::Vector3d& p) const;
  /// Whether places differ from those of the built-in patient.
  bool is_reshaped() const { return warp_ != nullptr; }

  // Signed distances to the surfaces, mm, negative inside: the fields divided by their gradients.
  double upper_bone(const Eigen::Vector3d& p) const;  // skull and upper teeth
  double lower_bone(const Eigen::Vector3d& p) const;  // mandible and lower teeth
  double skin(const Eigen::Vector3d& p) const;

 private:
  PhantomSolid solid_;
  double tooth_growth_mm_ = 0;
  std::unique_ptr<HeadWarp> warp_;
};

}  // namespace condyle
