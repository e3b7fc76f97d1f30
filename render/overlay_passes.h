#pragma once

#include <map>
#include <span>
#include <string>

#include "render/overlays.h"
#include "render/passes.h"

namespace condyle {

/// What is drawn beside the surfaces. The steps leave depth test on, blending off.
class OverlayPasses {
 public:
  OverlayPasses();

  void set_lines(const std::string& name, const LineSet& lines);

  /// Closes the opaque solids that the clipping plane cuts; needs a stencil, and does nothing
  /// without one.
  void caps(std::span<const DrawItem> items, const PictureView& view);
  void wireframe(const DrawItem& item, const PictureView& view);
  /// The part as at rest: behind what is nearer, its nearest layer alone.
  void ghost(const DrawItem& item, const Ghost& look, const PictureView& view);
  void lines(const PictureView& view, int width, int height);

 private:
  struct Lines {
    LineSet set;
    GpuLines lines;
    GpuPoints dots;
  };
  void begin(GlProgram& program, const PictureView& view, const Eigen::Matrix4f& model);

  GlProgram cap_, tint_, depth_, line_, dot_;
  GlVertexArray quad_;
  GlBuffer corners_;
  std::map<std::string, Lines> sets_;
};

}  // namespace condyle
