#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <span>
#include <vector>

#include "sim/frame/part.h"

namespace condyle {

/// Height of the lowest surface above a level, projected from below, on a horizontal grid: of
/// cranial bone and upper gums.
class Ceiling {
 public:
  Ceiling(std::span<const Part> parts, const Eigen::AlignedBox3d& region, double above);

  static constexpr double none = std::numeric_limits<double>::infinity();
  double at(double x, double y) const;

 private:
  void add(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

  Eigen::Vector2d low_;
  double above_;
  int columns_ = 0, rows_ = 0;
  std::vector<double> heights_;
};

/// From the lowest surface above to the lining: it lies within gums and crowns, but covers a palate
/// of bare bone. Cells hardly above the lowest of their row are crowns: the arch rises backward.
class AboveCeiling {
 public:
  AboveCeiling(std::span<const Part> parts, const Ceiling& bone, const Eigen::AlignedBox3d& region,
               double mid_z);
  /// Whether the palate is bone without gums.
  bool bare() const { return bare_; }
  double at(double y, double surface_z) const;

 private:
  bool bare_;
  double front_;
  std::vector<double> lowest_;
};

/// The soft palate continues from the end of the bone down to the throat.
struct SoftPalate {
  double begin_y, begin_z, lowest_z;
  double at(double y) const;
};

/// Half the width of the mouth by the distance behind the teeth: it never narrows.
class MouthWidth {
 public:
  MouthWidth(std::span<const Eigen::Vector3d> arches, const Eigen::AlignedBox3d& teeth);
  double at(double y) const;

 private:
  double front_;
  std::vector<double> half_;
};

/// The space between jaws and palate from the arches to the throat, which the lining follows; mm.
struct MouthSpace {
  /// arches: vertices of both. mid_z: height of the closed lips.
  MouthSpace(std::span<const Part> parts, std::span<const Eigen::Vector3d> arches, double mid_z);

  // from the lip line to where the cheek meets the jaw
  static constexpr double fornix_up_mm = 11.5;
  static constexpr double fornix_down_mm = 13;  // to the upper and to the lower jaw
  static constexpr double tongue_down_mm = 3;   // from the lip line to the back of a resting tongue
  // visible surfaces lie in front of the lining by this much
  static constexpr double within_mm = 1.5;
  static constexpr double highest_palate_mm = 32;  // above the lip line

  Eigen::AlignedBox3d teeth;
  double mid_z, throat_y;
  bool tongueless;  // the patient has no tongue of its own
  Ceiling bone;
  AboveCeiling above;
  MouthWidth width;
  SoftPalate soft;
};

}  // namespace condyle
