#pragma once

#include "render/drawn_box.h"
#include "render/gl_objects.h"

namespace condyle {

/// What is seen of surfaces, pixel by pixel, before and after it is lit: deferred shading. Every
/// pixel that is seen is lit once. Without a card that counts most for small triangles, as whole
/// blocks of pixels are worked on for each that touches them.
/// source: Saito and Takahashi, Comprehensible Rendering of 3-D Shapes, 1990
class SurfaceBuffer {
 public:
  /// Surfaces are told apart by numbers from 1 to this.
  static constexpr int most_surfaces = 255;

  /// Whether pictures of this size can be kept.
  static bool fits(int width, int height);
  /// throws: MachineError when the driver has no memory for it.
  void fit(int width, int height);

  /// Binds and clears what surfaces are drawn into, within a box.
  void begin_surfaces(const DrawnBox& box);
  void number_surface(int number) const;
  /// From here to `end`, only pixels of the numbered surface are drawn, lit, within a box.
  void begin_light();
  void light(int number, const DrawnBox& box) const;
  void end() const;

  GLuint words() const { return words_; }
  GLuint away() const { return away_; }
  GLuint depth() const { return depth_; }
  GLuint lit() const { return lit_; }

 private:
  GlFramebuffer surfaces_, light_;
  GlTexture words_;  // RGBA, 32 bit: see the shaders
  GlTexture away_;   // before the eye, mm; huge where nothing is
  GlTexture lit_;    // as displayed, and the surface's number
  GlTexture depth_;  // of the window, with the numbers as stencil
  int width_ = 0, height_ = 0;
};

}  // namespace condyle
