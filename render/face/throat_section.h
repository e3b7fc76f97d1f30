#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "engine/math/pose.h"
#include "sim/frame/part.h"

namespace condyle {

/// Outline of a soft part in the median plane, extruded to both sides.
struct SectionOutline {
  enum class Tissue { flesh, air, mucosa, muscle, bone };
  Tissue tissue;
  float half_width;                          // mm
  bool with_tongue;                          // shown where the tongue is shown
  std::vector<Eigen::Vector2f> points = {};  // y, z, mm: closed, in the cranium's frame
  float middle = 0;                          // x of the median plane, mm
};

/// Schematic soft parts inside a face that has a tongue: airway from the choanae to the trachea,
/// soft palate, epiglottis, root of the tongue, hyoid. Placed and scaled by the box of the tongue.
/// As the jaw opens, the root bends with the tongue, and the airway yields backward as far as
/// needed for mandible, tongue and hyoid: it keeps about seven tenths of its depth. (A neck would
/// extend to make room.) For pictures alone.
/// source: proportions of a median section, Gray's Anatomy, 41st ed.
class ThroatSection {
 public:
  /// One value, mm, for each of a row of heights.
  using Levels = std::vector<float>;

  /// parts: of the patient, at rest.
  explicit ThroatSection(std::span<const Part> parts);

  /// Whether there is a tongue to place it by.
  bool exists() const { return !tongue_.isEmpty(); }
  /// Later ones lie over earlier ones; the same number of points for each pose. X_CM: pose of the
  /// tongue's body. Empty without a tongue.
  std::vector<SectionOutline> at(const Pose& X_CM) const;

 private:
  float height(std::size_t level) const;
  std::size_t level_at(float z) const;
  void find_walls();
  Levels overlap(const Pose& X_CM, std::span<const SectionOutline> bent) const;

  Eigen::AlignedBox3f tongue_;
  float palate_tip_z_ = 0;
  std::vector<SectionOutline> rest_;
  std::vector<Eigen::Vector3f> tongue_middle_, jaw_middle_;  // vertices beside the median plane
  Levels front_, back_, overlap_at_rest_;                    // y of the airway's walls at rest
};

}  // namespace condyle
