#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <map>
#include <span>

#include "render/background.h"
#include "render/colour_map.h"
#include "render/drawable.h"
#include "render/drawn_box.h"
#include "render/framebuffer.h"
#include "render/lights.h"
#include "render/shaders.h"
#include "render/surface_buffer.h"
#include "render/visibility.h"

namespace condyle {

/// A drawable as one picture wants it.
struct DrawItem {
  Drawable* drawable;
  double opacity;         // above 0; 1 is drawn as opaque
  Eigen::Matrix4f model;  // rigid, from rest to now
  bool clipped = false;   // by the picture's plane
  bool holed = false;     // by its ball

  bool cut() const { return clipped || holed; }
  Role role() const { return drawable->part->role; }
  bool opaque() const { return opacity >= 1; }
  const GpuMesh& mesh() const { return drawable->shown(); }
  /// What is drawn of it. Values are shown where they are, on all of its triangles.
  const GpuMesh::Surface& surface(bool coarse) const {
    return coarse && !drawable->mapped ? mesh().coarse() : mesh().fine();
  }
  /// Box of where it is now, mm.
  Eigen::AlignedBox3f box() const;
};

/// What all draws of one picture share.
struct PictureView {
  Eigen::Matrix4f view, projection, view_projection, shadow;
  Eigen::Vector3f eye;
  int width, height;  // pixels
  DrawnBox box;       // of what is drawn
  bool one_sample = true;
  Lights lights;
  float pixels_per_unit;  // of a length across the line of sight at distance 1
  bool shadows = true;
  bool light = false;        // the backdrop: bright lines get a dark border
  bool coarse = false;       // shapes, where they serve
  bool dark_mouth = false;   // an opaque face keeps the sky out of it, but for its window
  bool opaque_face = false;  // hides most of the rest
  bool may_cull = true;      // the eye is outside of everything
  float skin_opacity = 1;
  bool sectioned = false;                     // through an opaque face, its mouth open to the eye
  float at_rest = 1;                          // 1 with the jaw at rest, 0 when it is well away
  float lips_y = 0;                           // front of the teeth, mm
  float away = 600;                           // of the target from the eye, mm
  Eigen::Vector4f clip_plane = {0, 0, 0, 1};  // product with what is kept: > 0
  Eigen::Vector3f cut_normal = Eigen::Vector3f::UnitX();        // toward what is left out
  bool capped = false;                                          // cut solids get faces
  Eigen::Vector4f cut_ball = {0, 0, 0, -1};                     // centre, radius
  Eigen::Vector4f window_ball = {0, 0, 0, -1};                  // the same, where it cuts skin
  float mapped_up_to = std::numeric_limits<float>::infinity();  // values beyond are not shown

  /// Of a dot at a place: at least so many pixels to each side.
  float radius_px(const Eigen::Vector3f& place, float radius_mm) const {
    const float distance = (place - eye).norm() - 2 * radius_mm;
    return 3 + pixels_per_unit * 1.5f * radius_mm / std::max(distance, 1.f);
  }
  /// Tells a program how pixel and depth make a place.
  void set_rays_in(GlProgram& program) const;
};

// A plane and a ball that cut nothing.
inline const Eigen::Vector4f nothing_clipped = {0, 0, 0, 1}, no_ball = {0, 0, 0, -1};

/// Tells the program in use what is cut of a part.
void set_cut(GlProgram& program, const DrawItem& item, const PictureView& view);
/// The same, and lets it be cut until `end_cut`.
void begin_cut(GlProgram& program, const DrawItem& item, const PictureView& view);
void end_cut();

/// The steps of a picture, in the order in which they run. They leave depth test on, blending off.
class Passes {
 public:
  Passes();

  /// Of all parts drawn by their values.
  void set_colour_map(const ColourMap& map);

  void shadow_map(std::span<const DrawItem> items, const PictureView& view);
  void background(const PictureView& view, Backdrop shade);
  void opaque(std::span<const DrawItem> items, const PictureView& view);
  /// Where they fall.
  static void add_contacts(std::span<const Eigen::Vector3f> points, PictureBounds& bounds,
                           const PictureView& view);
  /// `through`: also faintly through what lies in front.
  void contacts(const GpuPoints& points, const PictureView& view, bool through);
  /// Far to near, the face last; of each part only its front layer.
  void translucent(std::span<const DrawItem> items, const PictureView& view);

 private:
  /// Programs of one source, built when they are first wanted.
  class Programs {
   public:
    Programs(const char* what, ShaderSource (*source)(const Shading&))
        : what_(what), source_(source) {}
    GlProgram& of(const Shading& shading);

   private:
    const char* what_;
    ShaderSource (*source_)(const Shading&);
    std::map<Shading, GlProgram> built_;
  };

  /// Tells the program in use where things are, and what is cut of them.
  void place(GlProgram& program, const DrawItem& item, const PictureView& view);
  GlProgram& begin(Programs& programs, const DrawItem& item, const PictureView& view,
                   bool deferred);
  /// Its front, or both sides of what is open.
  const std::vector<Eigen::Vector3i>& seen_of(const DrawItem& item, const PictureView& view);
  void shade(const DrawItem& item, const PictureView& view);
  void shade_interior(const DrawItem& item, const PictureView& view);
  /// All of these, each pixel that is seen lit once.
  void deferred(std::span<const DrawItem> items, const PictureView& view);
  void depth_only(const DrawItem& item, const PictureView& view);

  Programs surfaces_, skins_, interiors_, kept_;
  GlProgram depth_, marker_, carry_, place_;
  GlVertexArray no_attributes_;
  SurfaceBuffer buffer_;
  Background background_;
  GlTexture skin_table_, skin_detail_, colour_table_;
  ColourMap colour_map_;
  DepthMap shadow_map_;
  Visibility visibility_;
  CoverGrid cover_;  // by the opaque face
};

}  // namespace condyle
