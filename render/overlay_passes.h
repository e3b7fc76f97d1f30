#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include "render/drawn_box.h"
#include "render/hollow_mouth.h"
#include "render/overlays.h"
#include "render/passes.h"

namespace condyle {

/// Whether cut solids show closed faces to the eye: asked for, seen from the side that is left out,
/// and with a stencil to find them.
bool shows_caps(const PictureView& view);

/// What is drawn beside the surfaces. The steps leave depth test on, blending off.
class OverlayPasses {
 public:
  OverlayPasses();

  void set_lines(const std::string& name, const LineSet& lines);
  void set_sheet(const std::string& name, const GlassSheet& sheet);

  /// Closes the opaque solids that the clipping plane cuts, the face but for its mouth if that is
  /// given, in its place.
  void caps(std::span<const DrawItem> items, const PictureView& view, const HollowMouth* mouth);
  void wireframe(const DrawItem& item, const PictureView& view);
  /// The part as at rest: behind what is nearer, its nearest layer alone.
  void ghost(const DrawItem& item, const Ghost& look, const PictureView& view);
  void lines(const PictureView& view, int width, int height);
  /// Where lines, their dots and sheets fall.
  void add_bounds(PictureBounds& bounds, const PictureView& view) const;
  /// In the order of their names, each over those before it.
  void sheets(const PictureView& view);

 private:
  struct Lines {
    LineSet set;
    GpuLines lines;
    GpuPoints dots;
  };
  struct ShownSheet {
    std::vector<Eigen::Vector3f> positions;
    std::vector<Eigen::Vector3i> triangles;
    Eigen::Vector3f color;
    float opacity;
    std::optional<GpuMesh> mesh;
  };
  /// The nearest layer of a mesh, tinted, behind what is nearer. `moved`: see the tint's shader.
  void glass(const GpuMesh& mesh, const Eigen::Vector3f& color, float opacity,
             const PictureView& view, float moved = 0);
  void begin(GlProgram& program, const PictureView& view, const Eigen::Matrix4f& model);

  GlProgram cap_, tint_, depth_, line_, dot_;
  GlVertexArray quad_;
  GlBuffer corners_;
  std::map<std::string, Lines> sets_;
  std::map<std::string, ShownSheet> sheets_;
  std::vector<Eigen::Vector3f> normals_;  // kept for its memory
};

}  // namespace condyle
