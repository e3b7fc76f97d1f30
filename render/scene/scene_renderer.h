#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/camera/camera.h"
#include "render/image/backdrop.h"
#include "render/image/colour_map.h"
#include "render/image/drawn_box.h"
#include "render/image/image.h"
#include "render/life/life_signs.h"
#include "render/overlay/overlays.h"
#include "sim/frame/before_operation.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/part.h"

namespace condyle {

/// Settings of a picture.
struct PictureSettings {
  int width = 1280, height = 720;
  int samples = 4;  // of multisampling; limited by the context
  bool shadows = true;
  bool coarse = false;   // shapes within 0.2 mm, skin and tongue without relief: for fast pictures
  bool contacts = true;  // mark contact points
  bool folds = true;     // of compressed skin: see skin_folds.h
  /// Signs of life at the frame's time, where shows_life. The camera must be that of
  /// seeing_extension.
  std::optional<Life> life = {};
  bool before_operation = false;  // with the parts that an operation removed, without its grafts
  Backdrop backdrop = Backdrop::dark;
  bool transparent = false;                    // no backdrop
  double skin_opacity = 1.0;                   // 0 hides the face
  std::map<std::string, double> part_opacity;  // by part name; missing = 1; 0 hides
  std::optional<ClippingPlane> clip = {};
  std::optional<CutAway> cut_away = {};
  std::optional<Ghost> ghost = {};
  // parts drawn with the edges of their triangles; "*" = all
  std::vector<std::string> wireframe = {};
  /// Parts are coloured only where the value is at most this, as contact patches; elsewhere they
  /// have their own appearance.
  std::optional<float> mapped_up_to = {};
  // Fraction of the width that is drawn; the rest of the target is unchanged: for a wipe between
  // two states. Only for `draw`.
  double from_x = 0, to_x = 1;
  // Only for `picture`:
  bool smooth_edges = false;  // FXAA, for pictures without multisampling
  int supersampling = 1;      // drawn this many times as wide and high, then averaged; 1 to 4
};

/// Draws a case at a frame. Needs a current OpenGL 3.3 core context for its lifetime.
class SceneRenderer {
 public:
  /// Uploads every part once. The parts must outlive the renderer. `operation`: after which the
  /// patient is shown, for pictures of the state before it.
  explicit SceneRenderer(std::span<const Part> patient,
                         std::shared_ptr<const BeforeOperation> operation = {});
  /// The same parts at rest for another context: computed data is copied. The other renderer must
  /// be unchanged since construction, and idle.
  explicit SceneRenderer(const SceneRenderer& other);
  ~SceneRenderer();
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  /// Bounding box of everything that can be drawn, at rest, mm.
  std::pair<Eigen::Vector3d, Eigen::Vector3d> bounds() const;

  /// Sets poses, face and contacts of a frame (normals and folds of the face are computed
  /// when it is drawn).
  void update(const FrameState& frame);

  /// The map of all parts that are coloured by values.
  void set_colour_map(const ColourMap& map);

  /// Gives a bone or an arch a finer mesh of the same surface, to be drawn while it is coloured by
  /// values. normals: unit, one per vertex. Unknown names are ignored.
  void set_finer(const std::string& name, const TriMesh& surface,
                 std::span<const Eigen::Vector3f> normals);

  /// Colours a part by one value per vertex (of its finer mesh, if it has one); without values its
  /// own appearance is restored. Values beyond the map, infinite ones too, have its outer colours.
  void color_part(const std::string& name, std::span<const float> values);

  /// Sets the lines of this name; empty ones are removed. Drawn in the order of the names.
  void set_lines(const std::string& name, const LineSet& lines);
  /// The same for a translucent surface.
  void set_sheet(const std::string& name, const GlassSheet& sheet);
  /// The same for a body of fibres. Cut by a plane that cuts all parts; faint behind opaque skin.
  void set_body(const std::string& name, const FibreBody& body);

  /// The box in which a picture shows anything but the background, with `drawn_air` around it.
  DrawnBox drawn_box(const Camera& camera, const PictureSettings& settings) const;

  /// Draws into the bound framebuffer, of width x height; within the box only, if one is given.
  void draw(const Camera& camera, const PictureSettings& settings,
            const std::optional<DrawnBox>& within = {});

  /// Draws off-screen and reads the picture back.
  Image picture(const Camera& camera, const PictureSettings& settings);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
