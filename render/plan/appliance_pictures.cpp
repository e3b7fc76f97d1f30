#include "render/plan/appliance_pictures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/mesh/measure.h"
#include "render/plan/picture_grid.h"
#include "render/scene/scene_renderer.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

const Eigen::Vector3f appliance_tint{0.42f, 0.66f, 0.86f};  // sRGB
constexpr int panel_width = 720, panel_height = 560;

Camera camera_on(const TriMesh& appliance, const ApplianceView& view) {
  Camera camera;
  camera.direction = view.toward_eye.normalized();
  camera.up = view.up;
  const Vector3d right = view.up.cross(camera.direction).normalized();
  const Vector3d up = camera.direction.cross(right);
  const Box box = bounding_box(appliance);
  camera.target = box.center();
  double half_wide = 0, half_high = 0, front = 0;
  for (const Vector3d& p : appliance.vertices) {
    const Vector3d d = p - camera.target;
    half_wide = std::max(half_wide, std::abs(d.dot(right)));
    half_high = std::max(half_high, std::abs(d.dot(up)));
    front = std::max(front, d.dot(camera.direction));
  }
  const double aspect = double(panel_width) / panel_height;
  const double half = view.margin * std::max(half_high, half_wide / aspect);
  camera.distance_mm =
      front + half / std::tan(0.5 * camera.field_of_view_deg * 3.14159265358979 / 180);
  return camera;
}

}  // namespace

Image appliance_sheet(const TriMesh& appliance, const AppliancePicture& picture) {
  PictureSettings settings;
  settings.width = panel_width;
  settings.height = panel_height;
  settings.backdrop = Backdrop::light;
  settings.contacts = false;
  PictureGrid grid{picture.title, {}, {}, picture.lines};
  for (std::size_t i = 0; i < picture.views.size(); ++i) {
    const ApplianceView& view = picture.views[i];
    std::vector<Part> parts = view.parts;
    for (Part& part : parts) part.body = cranium_body;
    Part shown{"appliance", Role::segment, appliance, {}, cranium_body};
    shown.mesh.colors.assign(appliance.vertices.size(), appliance_tint);
    parts.push_back(std::move(shown));
    SceneRenderer renderer(parts);
    FrameState frame;
    frame.poses = BodyPoses(std::vector<Pose>{Pose{}});
    renderer.update(frame);
    if (i % 2 == 0) grid.rows.emplace_back();
    grid.rows.back().push_back(
        {renderer.picture(camera_on(appliance, view), settings), view.heading});
  }
  return draw_grid(grid);
}

}  // namespace condyle
