#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "render/face/cheek_thickness.h"
#include "render/face/mouth_lining.h"
#include "render/face/skin_folds.h"
#include "render/face/submental_pad.h"
#include "render/gl/gpu_mesh.h"
#include "render/mesh/cover_grid.h"
#include "render/mesh/creases.h"
#include "render/shaders/material.h"
#include "sim/frame/part.h"

namespace condyle {

/// A part ready to be drawn.
struct Drawable {
  const Part* part;
  Material material;
  bool closed;              // its back is never visible
  Eigen::AlignedBox3f box;  // at rest, mm
  GpuMesh mesh;
  std::vector<Crease> creases;                      // of a face only
  std::vector<GpuMesh::Bytes> colors, extras;       // at rest, one per vertex
  std::optional<SurfaceEdges> edges, coarse_edges;  // of a face only, for occlusion culling

  /// sRGB, of the skin around the lashes of an eyes part; none without.
  std::optional<Eigen::Vector3f> behind_lashes = {};
  bool mapped = false;                // coloured by its values
  bool papillae = false;              // has the back of a tongue
  std::optional<GpuMesh> finer = {};  // drawn instead while it is mapped
  std::size_t finer_vertices = 0;
  std::vector<Eigen::Vector3f> undressed = {};  // vertices of a finer mesh without colours as yet
  bool covered = false;
  bool relief_moved = false;
  std::vector<Eigen::Vector3i> own = {};  // triangles, where they are a subset of the part's
  std::vector<int> uneven = {};           // a rim of theirs, drawn smooth
  std::span<const Eigen::Vector3i> triangles() const {
    return own.empty() ? part->mesh.triangles : own;
  }
  std::optional<GpuMesh> at_rest = {};          // of a deforming part, for its ghost
  std::shared_ptr<const SkinFolds> folds = {};  // of a face only
  std::shared_ptr<const CheekThickness> cheeks = {};
  std::shared_ptr<const SubmentalPad> pad = {};
  Eigen::AlignedBox3f lips = {};       // about the mouth of a face, at rest; empty without one
  std::optional<float> neck_cut = {};  // height of a face's lower end, where it is closed, mm
  float skin_light = 0;                // median linear luminance of the colours of a face

  const GpuMesh& shown() const { return mapped && finer ? *finer : mesh; }
  /// The same surface in smaller triangles, for maps.
  void set_finer(const TriMesh& surface, std::span<const Eigen::Vector3f> normals);

  /// Copies the colours and shade of the part to the finer mesh.
  void dress_finer();
  /// Prepares winding numbers of the solid (see cut_cover.h). Rims that another surface closes are
  /// given as constant triangles that would close them.
  void cover(std::span<const Eigen::Vector3i> closed_otherwise = {});
  /// The part at rest.
  const GpuMesh& rest_mesh();

  /// Changes of a face's shape in pictures alone.
  struct FaceLook {
    bool folded = true;  // with folds of its skin, thickness of its cheeks, pad under its chin
    // Moves its vertices and returns the shade of creases.
    std::function<std::vector<SkinFolds::Shade>(std::span<Eigen::Vector3f>)> alive = {};
    // Moves the places, at rest, that the fine relief of its skin is tied to.
    std::function<void(std::span<Eigen::Vector3f>)> relief = {};
  };
  /// Sends a deformed face, its normals and the shade of its creases.
  void move_face(std::vector<Eigen::Vector3f> positions, const FaceLook& look,
                 std::vector<Eigen::Vector3f>& normals_scratch);
};

/// Uploads the parts with their normals, colours, baked ambient occlusion and curvature. mouth: of
/// the first face; null without one.
std::vector<Drawable> make_drawables(std::span<const Part* const> parts,
                                     const MouthLining* mouth = nullptr);
/// Some triangles of a part as a separate drawable.
Drawable piece_of(const Drawable& whole, std::span<const Eigen::Vector3i> triangles);
/// The same for another context, at rest.
std::vector<Drawable> drawables_like(std::span<const Drawable> others);

}  // namespace condyle
