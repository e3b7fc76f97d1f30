#include "render/output/contact_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/image/glyphs.h"
#include "render/image/raster_2d.h"
#include "render/overlay/legend.h"
#include "render/scene/scene_renderer.h"
#include "sim/frame/part_names.h"

namespace condyle {
namespace {

constexpr int page_width = 1600, margin = 24, panel = 440, panel_height = 460, top = 108;
constexpr int legend_left = margin + 3 * (panel + margin) + 4;
constexpr int line_height = 26, text_height = 20;
const Eigen::Vector3f grey = Eigen::Vector3f::Constant(0.35f);

void paste(Image& image, const Image& part, int x, int y) {
  for (int row = 0; row < part.height; ++row)
    std::copy_n(&part.rgba[4 * static_cast<std::size_t>(row) * part.width],
                4 * static_cast<std::size_t>(part.width),
                &image.rgba[4 * (static_cast<std::size_t>(y + row) * image.width + x)]);
}

/// Views the point from `direction`; occluding surfaces are cut away.
Camera close_camera(const ContactView& place, const Eigen::Vector3d& direction) {
  constexpr double eye_mm = 260;
  const double uncut_mm = 0.4 * place.seen_mm;
  Camera camera;
  camera.target = place.middle;
  camera.direction = direction;
  // Upright as the patient; viewed from above or below, anterior is up.
  camera.up = std::abs(direction.z()) < 0.85 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(0, -1, 0);
  camera.distance_mm = eye_mm;
  camera.field_of_view_deg = 2 * std::atan(place.seen_mm / 2 / eye_mm) * 180 / std::numbers::pi;
  camera.near_mm = eye_mm - uncut_mm;
  return camera;
}

/// L or R, A or P, S or I: the patient's direction that a direction of the picture shows.
char letter_of(const Eigen::Vector3d& direction) {
  Eigen::Index axis = 0;
  direction.cwiseAbs().maxCoeff(&axis);
  return "LRPASI"[2 * axis + (direction[axis] < 0)];
}

class Sheet {
 public:
  Sheet(const ContactView& place, const ColourMap& map) : place_(place), map_(map) {
    for (const auto& line : place.lines)
      for (auto& part : words_.lines(line, text_height, page_width - 2 * margin))
        lines_.push_back(std::move(part));
    image_.width = page_width;
    image_.height = top + panel_height + margin + line_height * static_cast<int>(lines_.size() + 1);
    image_.rgba.assign(4 * static_cast<std::size_t>(image_.width) * image_.height, 255);
  }

  Image draw() {
    words_.write(image_, margin, 42, 32, place_.title);
    SceneRenderer renderer(place_.parts);
    FrameState state;
    state.poses = place_.at;
    renderer.update(state);
    const auto [low, high] = renderer.bounds();
    add_panel(
        renderer, 0, "location",
        standard_camera(place_.overview, low, high, static_cast<double>(panel) / panel_height), "");
    renderer.set_colour_map(map_);
    renderer.color_part(place_.fixed, place_.fixed_values);
    renderer.color_part(place_.moved, place_.moved_values);
    add_panel(renderer, 1,
              display_name(place_.fixed) + ", seen from " + readable_name(place_.moved),
              close_camera(place_, place_.normal), place_.fixed);
    add_panel(renderer, 2,
              display_name(place_.moved) + ", seen from " + readable_name(place_.fixed),
              close_camera(place_, -place_.normal), place_.moved);
    draw_legend(image_, words_, map_,
                {.left = legend_left, .top = top - 32, .bar_height = panel_height - 54});
    int y = top + panel_height + margin + 10;
    for (const auto& line : lines_) {
      words_.write(image_, margin, y, text_height, line);
      y += line_height;
    }
    words_.write(image_, margin, y, 16, "For research and education, not for clinical use.", grey);
    return std::move(image_);
  }

 private:
  /// `only`: the one part that is drawn; empty for all.
  void add_panel(SceneRenderer& renderer, int number, const std::string& name, const Camera& camera,
                 const std::string& only) {
    PictureSettings settings;
    settings.width = panel;
    settings.height = panel_height;
    settings.shadows = false;
    settings.contacts = false;
    if (!only.empty())
      for (const auto& part : place_.parts) settings.part_opacity[part.name] = part.name == only;
    const int x = margin + number * (panel + margin);
    paste(image_, renderer.picture(camera, settings), x, top);
    paint_frame(image_, {x, top, x + panel, top + panel_height}, grey);
    words_.write(image_, x, top - 14, 20, name);
    const Eigen::Vector3d right = camera.up.cross(camera.direction).normalized();
    const Eigen::Vector3d up = camera.direction.cross(right);
    const Eigen::Vector3f pale = Eigen::Vector3f::Constant(0.93f);
    const auto letter = [&](const Eigen::Vector3d& direction, int px, int py) {
      words_.write(image_, px, py, 22, std::string(1, letter_of(direction)), pale);
    };
    letter(-right, x + 8, top + panel_height / 2);
    letter(right, x + panel - 24, top + panel_height / 2);
    letter(up, x + panel / 2 - 6, top + 24);
    letter(-up, x + panel / 2 - 6, top + panel_height - 10);
    ring(camera, x, only.empty() ? 20 : 15);
    if (only.empty()) return;
    // A ruler, exact in the plane of the point.
    const double pixels_per_mm = panel_height / place_.seen_mm;
    const int length = static_cast<int>(std::lround(10 * pixels_per_mm));
    paint_box(image_, {x + 14, top + panel_height - 18, x + 14 + length, top + panel_height - 15},
              pale);
    words_.write(image_, x + 14, top + panel_height - 24, 16, "10 mm", pale);
  }

  /// Around the point, in a panel that starts at `left`.
  void ring(const Camera& camera, int left, double radius) {
    const Eigen::Vector4f p =
        projection_matrix(camera, static_cast<double>(panel) / panel_height, 1, 2000) *
        view_matrix(camera) * place_.place.cast<float>().homogeneous();
    const double px = left + panel * (0.5 + 0.5 * p.x() / p.w()),
                 py = top + panel_height * (0.5 - 0.5 * p.y() / p.w());
    constexpr double half = 2.2;  // of the yellow line; its dark edge is wider
    for (int y = static_cast<int>(py - radius) - 5; y <= py + radius + 5; ++y)
      for (int x = static_cast<int>(px - radius) - 5; x <= px + radius + 5; ++x) {
        const double off = std::abs(std::hypot(x + 0.5 - px, y + 0.5 - py) - radius);
        if (off > half + 1.2 || x < left || x >= left + panel || y < top || y >= top + panel_height)
          continue;
        paint_box(
            image_, {x, y, x + 1, y + 1},
            off > half ? Eigen::Vector3f(0.1f, 0.1f, 0.1f) : Eigen::Vector3f(0.94f, 0.89f, 0.26f));
      }
  }

  const ContactView& place_;
  const ColourMap& map_;
  Glyphs words_;
  std::vector<std::string> lines_;
  Image image_;
};

}  // namespace

Image contact_picture(const ContactView& place, const ColourMap& map) {
  return Sheet(place, map).draw();
}

}  // namespace condyle
