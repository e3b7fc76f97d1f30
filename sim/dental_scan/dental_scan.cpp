#include "sim/dental_scan/dental_scan.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <utility>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/pieces.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/rims.h"
#include "engine/mesh/topology.h"
#include "engine/mesh_io/mesh_files.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double least_arch_mm = 35, most_arch_mm = 120;  // largest extent
constexpr double usual_arch_mm = 85;                      // of a scan in another unit
constexpr double least_part_mm = 12;                      // of a part of an arch
constexpr double loose_fraction = 0.005;                  // of the area: specks
constexpr int least_triangles = 200;

/// Volume with every rim closed by a fan about its middle; its sign tells the side that faces out.
double fanned_volume(const TriMesh& mesh) {
  TriMesh closed = mesh;
  for (const auto& rim : rims_of(mesh)) {
    Vector3d middle = Vector3d::Zero();
    for (const int v : rim) middle += mesh.vertices[v] / static_cast<double>(rim.size());
    const int center = static_cast<int>(closed.vertices.size());
    closed.vertices.push_back(middle);
    for (std::size_t i = 0; i < rim.size(); ++i)
      closed.triangles.emplace_back(rim[i], rim[(i + 1) % rim.size()], center);
  }
  const Vector3d origin = bounding_box(closed).center();
  for (auto& v : closed.vertices) v -= origin;
  return signed_volume(closed);
}

/// Drops pieces of little area. Returns their number.
int drop_specks(TriMesh& mesh) {
  const Components pieces = find_components(mesh);
  return drop_components_below(mesh, pieces, component_areas(mesh, pieces),
                               loose_fraction * surface_area(mesh));
}

void check_arch_size(const TriMesh& mesh, const std::filesystem::path& file, bool partial) {
  const double extent = bounding_box(mesh).size().maxCoeff();
  const double least = partial ? least_part_mm : least_arch_mm;
  if (extent >= least && extent <= most_arch_mm) return;
  std::string fitting;
  for (const auto& [unit, mm] :
       {std::pair("cm", 10.0), std::pair("m", 1000.0), std::pair("in", 25.4)})
    if (extent * mm >= least_arch_mm && extent * mm <= usual_arch_mm && fitting.empty())
      fitting = fmt::format("; with --units {} it would fit", unit);
  throw InputError(file, "",
                   fmt::format("its longest side is {:.3g} mm; a scan of a dental arch has {:.0f} "
                               "to {:.0f} mm{}{}",
                               extent, least, most_arch_mm, fitting,
                               extent < least && !partial && fitting.empty()
                                   ? ", and a part of one needs picked points"
                                   : ""));
}

}  // namespace

DentalScan dental_scan(TriMesh mesh, const std::filesystem::path& file, bool partial) {
  DentalScan scan;
  scan.source = file.filename().string();
  weld(mesh);
  drop_degenerate(mesh);
  drop_duplicates(mesh);
  drop_unreferenced(mesh);
  if (static_cast<int>(mesh.triangles.size()) < least_triangles)
    throw InputError(file, "",
                     fmt::format("has {} triangles with an area; a dental scan has thousands",
                                 mesh.triangles.size()));
  check_arch_size(mesh, file, partial);
  scan.inward = fanned_volume(mesh) < 0;
  orient_outward(mesh);
  if (fanned_volume(mesh) < 0) flip(mesh);
  if (const int specks = drop_specks(mesh); specks > 0)
    scan.notes.push_back(
        fmt::format("{}: {} loose piece{} dropped", scan.source, specks, specks == 1 ? "" : "s"));
  if (scan.inward)
    scan.notes.push_back(scan.source + ": its triangles faced inward and were turned");
  check_arch_size(mesh, file, partial);
  scan.mesh = std::move(mesh);
  return scan;
}

DentalScan read_dental_scan(const std::filesystem::path& file, double unit_mm, bool partial) {
  TriMesh mesh = read_mesh(file);
  for (auto& v : mesh.vertices) v *= unit_mm;
  return dental_scan(std::move(mesh), file, partial);
}

}  // namespace condyle
