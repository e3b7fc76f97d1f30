#pragma once

#include <optional>

#include "render/gl/gl_objects.h"
#include "render/image/drawn_box.h"

namespace condyle {

/// G-buffer of deferred shading: the visible surface of each pixel, before and after lighting.
/// Every visible pixel is lit once. Without a GPU this matters most for small triangles, since
/// whole blocks of pixels are shaded for each triangle that touches them. source: Saito and
/// Takahashi, Comprehensible Rendering of 3-D Shapes, 1990
class SurfaceBuffer {
 public:
  /// Largest number of a surface; numbers start at 1.
  static constexpr int max_surfaces = 255;

  /// Whether pictures of this size can be stored.
  static bool fits(int width, int height);
  /// throws: MachineError when the driver is out of memory.
  void fit(int width, int height);

  /// Binds and clears the targets of the geometry pass, within a box.
  void begin_surfaces(const DrawnBox& box);
  void number_surface(int number) const;
  /// From here to `end`, only pixels of the numbered surface are drawn, lit, within a box.
  void begin_light();
  /// Sets the light within the box to 0.
  void clear_light(const DrawnBox& box) const;
  void light(int number, const DrawnBox& box) const;
  void end() const;

  GLuint words() const { return words_; }
  GLuint away() const { return away_; }
  GLuint depth() const { return depth_; }
  GLuint lit() const { return lit_; }
  /// Marks of pixels, for pictures with several samples; binds the target of those marks.
  GLuint edges() const { return marked_->edges; }
  void begin_edges();

 private:
  GlFramebuffer surfaces_, light_;
  GlTexture words_;  // RGBA, 32 bit: see the shaders
  GlTexture away_;   // distance from the eye, mm; huge where nothing is
  GlTexture lit_;    // as displayed, and the surface's number or opacity
  GlTexture depth_;  // of the window, with the numbers as stencil
  struct Marked {
    GlFramebuffer target;
    GlTexture edges;
    int width = 0, height = 0;
  };
  std::optional<Marked> marked_;  // from the first request on
  int width_ = 0, height_ = 0;
};

}  // namespace condyle
