#include "render/plan/face_pictures.h"

#include <array>
#include <utility>

#include "render/overlay/legend.h"
#include "render/plan/picture_grid.h"
#include "render/scene/scene_renderer.h"

namespace condyle {
namespace {

constexpr std::array face_views{"front", "three-quarter", "left"};

/// 1, 1.2, 1.5, 2, 3, 4, 5, 6, 8, 10, 12 ...: the end of the map's range.
double rounded_up(double mm) {
  double step = 1;
  while (true) {
    for (const double factor : {1.0, 1.2, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0})
      if (factor * step >= mm) return factor * step;
    step *= 10;
  }
}

FrameState face_frame(const Prediction& prediction, bool planned) {
  FrameState frame;
  frame.poses =
      planned ? prediction.operated.poses : completed(prediction.operated.patient.bodies, {});
  frame.face = planned ? prediction.after : prediction.before;
  return frame;
}

}  // namespace

std::vector<FacePicture> face_pictures(const Prediction& prediction) {
  std::vector<Part> parts = prediction.operated.patient.parts;
  std::string face;
  for (Part& part : parts)
    if (part.role == Role::face) {
      part.mesh = prediction.face;
      face = part.name;
    }
  SceneRenderer renderer(parts);
  PictureSettings settings;
  settings.width = 900;
  settings.height = 1000;
  settings.contacts = false;
  settings.folds = false;  // a prediction is of the face at rest
  const auto [low, high] = renderer.bounds();
  const ColourMap map = displacement_colours(rounded_up(prediction.max_displacement_mm()));
  renderer.set_colour_map(map);
  std::vector<float> moved;
  for (std::size_t i = 0; i < prediction.before.size(); ++i)
    moved.push_back((prediction.after[i] - prediction.before[i]).norm());
  const Glyphs words;
  std::vector<FacePicture> pictures;
  for (const char* view : face_views) {
    const Camera camera = standard_camera(view, low, high, 0.9);
    renderer.update(face_frame(prediction, false));
    pictures.push_back({"before", view, renderer.picture(camera, settings)});
    renderer.update(face_frame(prediction, true));
    pictures.push_back({"after", view, renderer.picture(camera, settings)});
    PictureSettings glass = settings;
    glass.skin_opacity = 0.25;
    pictures.push_back({"bones", view, renderer.picture(camera, glass)});
    renderer.color_part(face, moved);
    Image mapped = renderer.picture(camera, settings);
    add_legend(mapped, words, map, {"from before to after"});
    pictures.push_back({"map", view, std::move(mapped)});
    renderer.color_part(face, {});
  }
  return pictures;
}

Image face_sheet(const std::vector<FacePicture>& pictures, const std::string& title,
                 const std::vector<std::string>& lines) {
  PictureGrid grid{title, {{}, {}, {}}, {}, lines};
  constexpr std::array rows{"before", "after", "map"};
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (const FacePicture& picture : pictures)
      if (picture.what == rows[row])
        grid.rows[row].push_back({averaged(picture.image, 2), picture.what + ", " + picture.view});
  return draw_grid(grid);
}

}  // namespace condyle
