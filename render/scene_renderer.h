#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/backdrop.h"
#include "render/camera.h"
#include "render/colour_map.h"
#include "render/drawn_box.h"
#include "render/image.h"
#include "render/overlays.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// How a picture is drawn.
struct PictureSettings {
  int width = 1280, height = 720;
  int samples = 4;  // of multisampling; what the context cannot give is lowered
  bool shadows = true;
  bool coarse = false;   // shapes within 0.2 mm, for pictures that must come fast
  bool contacts = true;  // mark contact points
  Backdrop backdrop = Backdrop::dark;
  bool transparent = false;                    // nothing where the backdrop would be seen
  double skin_opacity = 1.0;                   // 0 hides the face
  std::map<std::string, double> part_opacity;  // by part name; missing = 1; 0 hides
  std::optional<ClippingPlane> clip = {};
  std::optional<CutAway> cut_away = {};
  std::optional<Ghost> ghost = {};
  std::vector<std::string> wireframe = {};  // parts drawn with their triangles' edges; "*" = all
  /// Parts coloured by values are so only where the value is at most this; elsewhere they look like
  /// themselves: patches of contact.
  std::optional<float> mapped_up_to = {};
  // Share of the width that is drawn; the rest of the target stays as it is: for two states with a
  // wipe. Only of `draw`.
  double from_x = 0, to_x = 1;
  // Only of `picture`:
  bool smooth_edges = false;  // FXAA, for pictures without multisampling
  int supersampling = 1;      // drawn this many times as wide and high, then averaged; 1 to 4
};

/// Draws a case at a frame. Needs a current OpenGL 3.3 core context for its whole life.
class SceneRenderer {
 public:
  /// Uploads every part once. The parts must outlive the renderer.
  explicit SceneRenderer(std::span<const Part> patient);
  /// The same parts at rest for another context: what was computed of them is taken over. The other
  /// must be as it was made, and idle.
  explicit SceneRenderer(const SceneRenderer& other);
  ~SceneRenderer();
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  /// Box of everything that can be drawn, at rest, mm.
  std::pair<Eigen::Vector3d, Eigen::Vector3d> bounds() const;

  /// Takes over poses, face and contacts of a frame (normals of the face are made here).
  void update(const FrameState& frame);

  /// The map of all parts that are coloured by values.
  void set_colour_map(const ColourMap& map);

  /// Gives a bone or an arch another mesh of the same surface, finer where values vary, to be drawn
  /// while it is coloured by values. normals: unit, one per vertex. Unknown names are passed over.
  void set_finer(const std::string& name, const TriMesh& surface,
                 std::span<const Eigen::Vector3f> normals);

  /// Colours a part by one value per vertex (of its finer mesh, if it has one) from now on; without
  /// values it is drawn as itself again. Values beyond the map, infinite ones too, have its outer
  /// colours.
  void color_part(const std::string& name, std::span<const float> values);

  /// Lines of this name from now on; empty ones are gone. Drawn in the order of the names.
  void set_lines(const std::string& name, const LineSet& lines);
  /// The same for a see-through surface.
  void set_sheet(const std::string& name, const GlassSheet& sheet);

  /// Where a picture shows anything but the background, with `drawn_air` around it.
  DrawnBox drawn_box(const Camera& camera, const PictureSettings& settings) const;

  /// Draws into the framebuffer that is bound, of width x height; within the box only, if one is
  /// given.
  void draw(const Camera& camera, const PictureSettings& settings,
            const std::optional<DrawnBox>& within = {});

  /// Draws off-screen and reads the picture back.
  Image picture(const Camera& camera, const PictureSettings& settings);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
