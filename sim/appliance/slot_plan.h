#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "engine/mesh/triangle_tree.h"
#include "sim/appliance/guide.h"

namespace condyle {

/// A straight run of the cut on the accessible side of the bone, along one wall. A point has the
/// coordinates t along the run, h out of the bone in the wall's plane, and w across it.
struct SlotRun {
  Eigen::Vector3d along, outward, across;  // unit, orthogonal
  double w0 = 0;                           // of the wall's plane
  std::vector<double> t, h;                // of its points on the bone, t increasing
  std::vector<double> even_h;              // smoothed, for the walls
  struct Slot {
    double low, high;  // t
  };
  std::vector<Slot> slots;

  /// Height of the bone's surface at t.
  double surface(double at) const { return height(h, at); }
  double even_surface(double at) const { return height(even_h, at); }
  Eigen::Vector3d point(double at) const {
    return at * along + surface(at) * outward + w0 * across;
  }

 private:
  double height(const std::vector<double>& heights, double at) const;
};

/// What a guide leads, seen from the side that it comes from.
struct SlotPlan {
  Eigen::Vector3d out =
      -Eigen::Vector3d::UnitY();        // unit: direction in which the guide is withdrawn
  std::vector<Eigen::Vector3d> points;  // of the line, accessible
  std::vector<SlotRun> runs;
  struct Bar {
    Eigen::Vector3d from, to;
    double lift_mm = 3.5;  // along the withdrawal path, over what lies between
  };
  static constexpr double bar_radius_mm = 2.2;
  std::vector<Bar> bars;  // between runs that no bone joins: points on the bone
  double line_mm = 0, led_mm = 0;
  double bone_mm = 0;
};

/// Chooses the side and divides the line into slots with bridges between them. throws: InputError
/// where no slot leads the saw from there.
SlotPlan plan_slots(const TriangleTree& bone, const ClinicalFrame& frame, const CutLine& line,
                    const GuideSettings& settings);

/// Adds bars between runs that were left to grow together. Returns whether there are more than
/// before.
bool join_with_bars(SlotPlan& plan, const TriangleTree& bone);

/// Two points on each side of the slots for screw holes: bone faces the guide, screws keep away
/// from dangers, and `has_shell` holds for the point and the axis. `diameter_mm` is the intended
/// one. Adds a note where there is no room.
std::vector<ScrewHole> plan_holes(
    const GuideSupport& support, const TriangleTree& bone, const SlotPlan& plan,
    const GuideSettings& settings,
    const std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>& has_shell,
    std::vector<std::string>& notes);

}  // namespace condyle
