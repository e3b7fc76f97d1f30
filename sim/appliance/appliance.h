#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {

/// How an appliance lies on teeth or bone, measured on its finished surface.
struct PrintMeasure {
  std::string on;                                          // "upper teeth", "mandible"
  Eigen::Vector3d seat = Eigen::Vector3d::UnitZ();         // direction of insertion, unit, cranium
  std::optional<double> tilt_deg;                          // of it from the arch's occlusal normal
  double area_mm2 = 0;                                     // of teeth or bone that the print covers
  double fit_max_mm = 0, fit_p95_mm = 0, fit_mean_mm = 0;  // distance from it to the print
  double overlap_mm = 0;   // deepest point of the appliance in teeth or bone; 0: none
  double undercut_mm = 0;  // deepest passage of the appliance through them on its withdrawal
  // Areas that do not count for the fit: undercuts and crevices of teeth or bone, where the print
  // was widened; its rounded rims; and what it lies in front of, but more than 0.6 mm away.
  double relieved_mm2 = 0, rim_mm2 = 0, not_reached_mm2 = 0;
};

/// A printable surface, measured again after it was made.
struct ApplianceMeasure {
  bool closed = false;  // every edge has two triangles that agree on outside
  int pieces = 0;
  int triangles = 0;
  double volume_mm3 = 0;
  double wall_min_mm = 0, wall_p5_mm = 0;             // thickness between facing walls
  Eigen::Vector3d wall_at = Eigen::Vector3d::Zero();  // where it is least, cranium
  double size_mm[3] = {0, 0, 0};
  std::vector<PrintMeasure> prints;
};

/// Voxels outside of these would give a surface that is too coarse, or fields too large.
constexpr double least_voxel_mm = 0.1, largest_voxel_mm = 0.6;

/// throws: InputError naming the value.
void check_voxel(double voxel_mm);

/// Seats the appliance's surface on what carries it.
struct PrintSettings {
  std::string on;
  Eigen::Vector3d seat = Eigen::Vector3d::UnitZ();
  double gap_mm = 0.1;
  double grip_mm = 0.4;
  double thin_mm = 1;  // crevices narrower than this are not printed
};

/// Closed, pieces, volume and walls. `tree`: of the same mesh, as below. Deterministic for any
/// number of threads.
ApplianceMeasure measure_appliance(const TriMesh& mesh, const TriangleTree& tree, int threads);

/// Fit, overlap and undercut of an appliance on the closed surface that it was made for.
PrintMeasure measure_print(const TriMesh& appliance, const TriangleTree& appliance_tree,
                           const TriMesh& support, const PrintSettings& settings, int threads);

/// Keeps the largest piece and drops cavities. Returns the volume of the largest other piece, mm³.
double keep_one_piece(TriMesh& mesh);

}  // namespace condyle
