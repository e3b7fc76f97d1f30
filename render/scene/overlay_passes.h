#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include "render/image/drawn_box.h"
#include "render/overlay/overlays.h"
#include "render/scene/mouth_cavity.h"
#include "render/scene/passes.h"
#include "render/scene/section_anatomy.h"

namespace condyle {

/// Whether cut solids show closed faces to the eye: requested, viewed from the removed side, and
/// with a stencil buffer to find them.
bool shows_caps(const PictureView& view);

/// Draws everything except the surfaces. Each pass leaves depth test on, blending off.
class OverlayPasses {
 public:
  OverlayPasses();

  void set_lines(const std::string& name, const LineSet& lines);
  void set_sheet(const std::string& name, const GlassSheet& sheet);
  void set_body(const std::string& name, const FibreBody& body);

  /// Closes the opaque solids that the clipping plane cuts; the face except for its mouth if that
  /// is given, in its place, and with the solids that only its section shows.
  void caps(std::span<const DrawItem> items, const PictureView& view, const MouthCavity* mouth,
            std::span<const SectionSolid> within = {});
  void wireframe(const DrawItem& item, const PictureView& view);
  /// The part at rest: behind nearer surfaces, only its nearest layer.
  void ghost(const DrawItem& item, const Ghost& look, const PictureView& view);
  void lines(const PictureView& view, int width, int height);
  /// Bounds of lines, their dots and sheets.
  void add_bounds(PictureBounds& bounds, const PictureView& view) const;
  /// In the order of their names, each over those before it.
  void sheets(const PictureView& view);
  /// `clipped`: by the picture's plane. Behind an opaque face they appear faintly through it.
  void bodies(const PictureView& view, bool clipped);

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
  struct ShownBody {
    FibreBody body;
    std::optional<GpuMesh> mesh;
  };
  /// The nearest layer of a mesh, tinted, behind nearer surfaces. `moved`: see the tint's shader.
  void glass(const GpuMesh& mesh, const Eigen::Vector3f& color, float opacity,
             const PictureView& view, float moved = 0);
  /// Marks in the stencil where the plane cuts a solid that `draw` draws, then fills it.
  template <class Draw>
  void cap(const DrawItem& item, const Eigen::Matrix4f& model, const Eigen::Vector3f& color,
           const PictureView& view, const Draw& draw);
  void begin(GlProgram& program, const PictureView& view, const Eigen::Matrix4f& model);

  GlProgram cap_, tint_, depth_, line_, dot_, fibres_;
  GlVertexArray quad_;
  GlBuffer corners_;
  std::map<std::string, Lines> sets_;
  std::map<std::string, ShownSheet> sheets_;
  std::map<std::string, ShownBody> bodies_;
  std::vector<Eigen::Vector3f> normals_;  // reused between frames
};

}  // namespace condyle
