#pragma once

#include <Eigen/Core>
#include <functional>
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

/// Seats the appliance's surface on what carries it.
struct PrintSettings {
  std::string on;
  Eigen::Vector3d seat = Eigen::Vector3d::UnitZ();
  double gap_mm = 0.1;
  double held_mm = 0.35;  // deeper undercuts are not printed
  double thin_mm = 1;     // nor are crevices narrower than this
  /// Distance from the body that the print was taken out of, negative inside: beside its borders
  /// are the rims of the print. Empty: rims lie beside what the appliance does not cover.
  std::function<double(const Eigen::Vector3d&)> body = {};
};

/// Closed, pieces, volume and walls. `tree`: of the same mesh, as below. Deterministic for any
/// number of threads.
ApplianceMeasure measure_appliance(const TriMesh& mesh, const TriangleTree& tree, int threads);

/// Fit, overlap and undercut of an appliance on the closed surface that it was made for.
PrintMeasure measure_print(const TriMesh& appliance, const TriangleTree& appliance_tree,
                           const TriMesh& support, const PrintSettings& settings, int threads);

/// What a print lies on, in the axes of the appliance's grid.
struct PrintedOn {
  const TriMesh& support;
  PrintSettings settings;
};
/// All of it for an appliance in the axes R of its grid; points and directions of the result are
/// the cranium's.
ApplianceMeasure measure_in_axes(const TriMesh& mesh, const TriangleTree& tree,
                                 const Eigen::Matrix3d& R, const std::vector<PrintedOn>& prints,
                                 int threads);

/// throws: InputError for an appliance that cannot be withdrawn: that passes through what carries
/// it by 0.5 mm more than its grip. `name`: "splint".
void check_withdrawal(const ApplianceMeasure& measure, double grip_mm, const std::string& name);

/// A wall that is thinner than another, and the middle of it.
struct ThinWall {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  double thickness_mm = 0;
};
/// Where the thickness between facing walls is below `least_mm`, thinnest first.
std::vector<ThinWall> find_thin_walls(const TriMesh& mesh, const TriangleTree& tree,
                                      double least_mm, int threads);

/// A loose part that is smaller is left out without a note.
constexpr double crumb_mm3 = 20;

/// Keeps the largest piece and drops cavities. Returns the volume of the largest other piece, mm³.
double keep_one_piece(TriMesh& mesh);

}  // namespace condyle
