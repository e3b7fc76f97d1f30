#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "render/gl/framebuffer.h"
#include "render/gl/surface_buffer.h"
#include "render/image/colour_map.h"
#include "render/image/drawn_box.h"
#include "render/scene/background.h"
#include "render/scene/drawable.h"
#include "render/scene/edge_pixels.h"
#include "render/scene/lights.h"
#include "render/scene/visibility.h"
#include "render/shaders/shaders.h"

namespace condyle {

inline constexpr float lash_pixels = 0.5f;  // least radius

/// A drawable with its settings in one picture.
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
  /// The surface that is drawn. Values are shown at full resolution, on all of its triangles.
  const GpuMesh::Surface& surface(bool coarse) const {
    return coarse && !drawable->mapped ? mesh().coarse() : mesh().fine();
  }
  /// Its current bounding box, mm.
  Eigen::AlignedBox3f box() const;
};

/// Constant data of all draws of one picture.
struct PictureView {
  Eigen::Matrix4f view, projection, view_projection, shadow;
  Eigen::Vector3f eye;
  int width, height;  // pixels
  DrawnBox box;       // of the drawn pixels
  bool one_sample = true;
  Lights lights;
  float pixels_per_unit;  // of a length across the line of sight at distance 1
  bool shadows = true;
  std::optional<Backdrop> backdrop;  // none: transparent
  bool light = false;                // of the backdrop: bright lines get a dark border
  bool coarse = false;               // coarse shapes where accurate enough
  // an opaque face excludes the sky from the mouth, except through its window
  bool dark_mouth = false;
  bool opaque_face = false;  // hides most of the rest
  bool may_cull = true;      // the eye is outside everything
  float skin_opacity = 1;
  bool sectioned = false;                     // a section of an opaque face with its mouth visible
  float at_rest = 1;                          // 1 with the jaw at rest, 0 when it is far from it
  float lips_y = 0;                           // front of the teeth, mm
  float away = 600;                           // distance of the target from the eye, mm
  Eigen::Vector4f clip_plane = {0, 0, 0, 1};  // dot product with kept points > 0
  Eigen::Vector3f cut_normal = Eigen::Vector3f::UnitX();        // towards the removed side
  bool capped = false;                                          // cut solids get faces
  Eigen::Vector4f cut_ball = {0, 0, 0, -1};                     // centre, radius
  Eigen::Vector4f window_ball = {0, 0, 0, -1};                  // the same, where it cuts skin
  float mapped_up_to = std::numeric_limits<float>::infinity();  // values beyond are not shown

  /// Radius of a dot at a point: at least this many pixels.
  float radius_px(const Eigen::Vector3f& place, float radius_mm) const {
    const float distance = (place - eye).norm() - 2 * radius_mm;
    return 3 + pixels_per_unit * 1.5f * radius_mm / std::max(distance, 1.f);
  }
  /// Sets the uniforms that reconstruct a point from pixel and depth.
  void set_rays_in(GlProgram& program) const;
};

// A plane and a ball that cut nothing.
inline const Eigen::Vector4f nothing_clipped = {0, 0, 0, 1}, no_ball = {0, 0, 0, -1};

/// Sets the cuts of a part in the program in use.
void set_cut(GlProgram& program, const DrawItem& item, const PictureView& view);
/// The same, with clipping enabled until `end_cut`.
void begin_cut(GlProgram& program, const DrawItem& item, const PictureView& view);
void end_cut();

/// The passes of a picture, in their order of execution. Each leaves depth test on, blending off.
class Passes {
 public:
  Passes();

  /// Draws all parts coloured by values.
  void set_colour_map(const ColourMap& map);

  void shadow_map(std::span<const DrawItem> items, const PictureView& view);
  /// Clears the box and draws the opaque items.
  void opaque(std::span<const DrawItem> items, const PictureView& view);
  /// The backdrop, unless `opaque` has drawn it.
  void background(const PictureView& view);
  /// Their bounds.
  static void add_contacts(std::span<const Eigen::Vector3f> points, PictureBounds& bounds,
                           const PictureView& view);
  /// `through`: also faintly through surfaces in front.
  void contacts(const GpuPoints& points, const PictureView& view, bool through);
  /// Far to near, the face last; of each part only its front layer.
  void translucent(std::span<const DrawItem> items, const PictureView& view);

 private:
  /// Variants of one program, built at first use.
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

  /// Sets the transforms and cuts in the program in use.
  void place(GlProgram& program, const DrawItem& item, const PictureView& view);
  GlProgram& begin(Programs& programs, const DrawItem& item, const PictureView& view,
                   bool deferred);
  /// Give a program the stored pixels, and these with their light.
  void see_stored(GlProgram& program);
  void see_lit(GlProgram& program, const PictureView& view);
  /// Its front, or both sides of an open surface.
  const std::vector<Eigen::Vector3i>& seen_of(const DrawItem& item, const PictureView& view);
  void shade(const DrawItem& item, const PictureView& view);
  void shade_interior(const DrawItem& item, const PictureView& view);
  /// Draws a surface into the buffer; lights its pixels there.
  void store(const DrawItem& item, int number, std::span<const Eigen::Vector3i> triangles,
             const PictureView& view);
  void light_stored(const DrawItem& item, int number, float alpha, const DrawnBox& box,
                    const PictureView& view);
  /// Deferred shading of all of these, each visible pixel lit once.
  void deferred(std::span<const DrawItem> items, const PictureView& view);
  /// Deferred shading of the front of a translucent item: blends it into a picture of one sample.
  void deferred_front(const DrawItem& item, const PictureView& view);
  /// Copies the lit pixels into the picture, with their depth: of one sample, with the backdrop, or
  /// of several.
  void place_all(const PictureView& view);
  void find_edges(const PictureView& view);
  void place_sampled(std::span<const DrawItem> items, const std::vector<char>& seen,
                     const PictureView& view, GLuint target);
  /// Makes these faces, where they are whole, hide what is drawn next.
  void cover_by(std::span<const DrawItem> faces, const PictureView& view);
  void depth_only(const DrawItem& item, const PictureView& view, Sides sides);

  Programs surfaces_, skins_, interiors_, kept_;
  GlProgram depth_, marker_, carry_, place_, blend_, edges_, inner_;
  GlVertexArray no_attributes_;
  SurfaceBuffer buffer_;
  Background background_;
  bool has_backdrop_ = false;  // the present picture
  GlTexture skin_table_, skin_detail_, colour_table_;
  ColourMap colour_map_;
  DepthMap shadow_map_;
  Visibility visibility_;
  CoverGrid cover_;  // by the opaque face, or a translucent one while it is drawn
  EdgePixels edge_pixels_;
  bool software_;  // no card
};

}  // namespace condyle
