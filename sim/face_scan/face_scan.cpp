#include "sim/face_scan/face_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/pieces.h"
#include "engine/mesh/refine.h"
#include "engine/mesh/repair.h"
#include "engine/mesh/topology.h"
#include "engine/mesh_io/mesh_files.h"
#include "engine/mesh_io/texture.h"
#include "sim/face_scan/depth_map_files.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

/// Drops the pieces smaller than a tenth of the largest one. Returns their number.
int drop_small_pieces(TriMesh& mesh) {
  constexpr double least_share = 0.1;
  if (mesh.triangles.empty()) return 0;
  const Components pieces = find_components(mesh);
  const std::vector<double> areas = component_areas(mesh, pieces);
  return drop_components_below(mesh, pieces, areas,
                               least_share * *std::max_element(areas.begin(), areas.end()));
}

TriMesh mesh_of_map(const fs::path& file, std::vector<std::string>& notes) {
  FaceDepthMap map = read_depth_map(file);
  notes.push_back(fmt::format(
      "face scan: {} depth map of {} x {} pixels, {}",
      map.kind == FaceDepthMap::Kind::plane ? "planar" : "cylindrical", map.width, map.height,
      map.rgb.empty() ? "no colours"
                      : fmt::format("colours {} x {}", map.colour_width, map.colour_height)));
  DepthMapRepair repair;
  TriMesh mesh = surface_of(std::move(map), repair);
  if (mesh.empty()) throw InputError(file, "depth", "holds no surface");
  notes.push_back(
      fmt::format("face scan: {} spikes dropped, {} holes filled with {} samples, {} steep "
                  "triangles left out",
                  repair.spikes, repair.holes, repair.filled_samples, repair.steep_triangles));
  return mesh;
}

TriMesh mesh_of_surface(const fs::path& file, const SourceFrame& frame,
                        std::vector<std::string>& notes) {
  constexpr int most_triangles = 300000;
  constexpr double share_of_edge = 1.3;  // only longer edges are halved
  TriMesh mesh = read_mesh(file);
  for (auto& v : mesh.vertices) v = frame.to_lps_mm() * v;
  if (frame.mirrored()) flip(mesh);
  drop_unreferenced(mesh);
  weld(mesh);
  drop_degenerate(mesh);
  drop_duplicates(mesh);
  orient_outward(mesh);
  if (mesh.empty()) throw InputError(file, "", "has no triangle with an area");
  const auto texture = mesh.colors.empty() ? read_texture(file) : std::nullopt;
  if (texture) {
    const double edge_mm =
        share_of_edge * std::sqrt(4 / std::sqrt(3.0) * surface_area(mesh) / most_triangles);
    mesh =
        refine(std::move(mesh), std::vector<double>(mesh.vertices.size(), edge_mm), most_triangles);
    paint(mesh, *texture, Eigen::Affine3d(frame.to_lps_mm()));
  }
  notes.push_back(fmt::format("face scan: {} triangles, {}", mesh.triangles.size(),
                              texture
                                  ? fmt::format("texture {} x {}", texture->width, texture->height)
                              : mesh.colors.empty() ? "no colours"
                                                    : "colours per vertex"));
  return mesh;
}

/// A face is 100 to 600 mm high or wide.
void check_size(const fs::path& file, const TriMesh& mesh, const SourceFrame& frame) {
  constexpr double least_mm = 60, most_mm = 1200;
  const double size = bounding_box(mesh).size().maxCoeff();
  if (size >= least_mm && size <= most_mm) return;
  const auto fits = [&](double factor) {
    return size * factor >= least_mm && size * factor <= most_mm;
  };
  const double in_mm = frame.to_lps_mm().col(0).norm();  // mm in a unit of the file
  const char* unit = fits(1000 / in_mm) ? "m"
                     : fits(10 / in_mm) ? "cm"
                     : fits(1 / in_mm)  ? "mm"
                                        : "";
  throw InputError(file, "",
                   fmt::format("is {:.3g} mm large, which is no face{}", size,
                               *unit ? fmt::format("; use --units {}", unit) : std::string()));
}

}  // namespace

FaceScan read_face_scan(const fs::path& file, const SourceFrame& frame) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  FaceScan scan;
  scan.mesh = extension == ".json" ? mesh_of_map(file, scan.notes)
                                   : mesh_of_surface(file, frame, scan.notes);
  if (const int dropped = drop_small_pieces(scan.mesh); dropped > 0)
    scan.notes.push_back(
        fmt::format("face scan: {} small piece{} dropped", dropped, dropped == 1 ? "" : "s"));
  check_size(file, scan.mesh, frame);
  return scan;
}

}  // namespace condyle
