#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/cut/region.h"
#include "sim/case/case.h"
#include "sim/osteotomy/osteotomy.h"
#include "sim/plan/clinical_frame.h"

namespace condyle {

enum class Side { left, right };
constexpr Side both_sides[] = {Side::left, Side::right};
constexpr double sign_of(Side side) { return side == Side::left ? 1 : -1; }
inline std::string name_of(Side side) { return side == Side::left ? "left" : "right"; }

/// A bone in the patient's own axes: x left, y back, z up, x = 0 in the midsagittal plane. All
/// points and directions are in these axes, planes and regions of results in the case's.
class SurgicalAnatomy {
 public:
  /// throws: InputError naming the landmark that the axes need.
  SurgicalAnatomy(const Case& patient, const Part& bone);

  const Case& patient() const { return patient_; }
  const TriMesh& bone() const { return bone_; }
  Eigen::Vector3d local(const Eigen::Vector3d& p) const {
    return frame_.components(p - frame_.origin);
  }

  std::optional<Eigen::Vector3d> find(const std::string& landmark) const;
  /// throws: InputError naming the landmark.
  Eigen::Vector3d need(const std::string& landmark) const;
  /// Middle between a landmark's left and right points; absent unless both are there.
  std::optional<Eigen::Vector3d> find_middle(const std::string& paired) const;
  /// All points of a tooth's mesh, where the case has it by itself. Empty: it has not.
  std::vector<Eigen::Vector3d> tooth_points(int fdi) const;
  /// Middle of the box of a tooth, along the patient's axes.
  std::optional<Eigen::Vector3d> tooth_middle(int fdi) const;
  /// Points that a cut must keep this far from.
  struct Danger {
    Eigen::Vector3d point;
    double margin_mm;
  };
  /// Centre lines of the canals of a body, with radius and margin.
  std::vector<Danger> canal_dangers(BodyId body, double margin_mm) const;

  Plane plane(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;
  Region above(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, int wall) const;
  Region sheet(std::span<const Eigen::Vector3d> polyline, const Eigen::Vector3d& direction,
               const Eigen::Vector3d& side, int first_wall) const;
  /// A place and a direction of the patient's axes as a station in the case's.
  CutStation station(std::string parameter, const Eigen::Vector3d& at,
                     const Eigen::Vector3d& per_unit) const;
  std::vector<Plane> box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const;

  /// Distances from the midsagittal plane at which the line at (y, z) crosses the surface of a
  /// side, outermost first; those within 5 mm of the plane are left out.
  std::vector<double> crossings(Side side, double y, double z) const;
  /// Range of a coordinate over the section of a side's surface, farther out than `least_x`, with
  /// a plane of constant y (axis 1) or z (axis 2).
  struct Range {
    Eigen::Vector3d low_at, high_at;
    double low, high;
  };
  std::optional<Range> section(Side side, int axis, double at, int coordinate,
                               double least_x) const;

  std::vector<std::string> notes;  // what was estimated
  std::vector<std::string> rooms;  // see PlacedOsteotomy

 private:
  const Case& patient_;
  ClinicalFrame frame_;
  TriMesh bone_;
};

}  // namespace condyle
