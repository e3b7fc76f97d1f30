#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "render/scene/face_shape.h"
#include "render/window/input/picking.h"
#include "render/window/panels/panels_drawing.h"
#include "render/window/window_state.h"
#include "sim/frame/body_poses.h"

namespace condyle {
namespace {

constexpr const char* preparing = "Preparing the picture";
constexpr double calm_s = 0.25;  // time without motion before full quality

constexpr double clock_interval_s = 0.05;  // update of the timeline while pictures are slower

/// Whether both yield the same picture.
bool same(const Camera& a, const Camera& b) {
  return a.target == b.target && a.direction == b.direction && a.up == b.up &&
         a.distance_mm == b.distance_mm;
}
bool same(const PictureSettings& a, const PictureSettings& b) {
  return a.width == b.width && a.height == b.height && a.shadows == b.shadows &&
         a.folds == b.folds && a.life == b.life && a.contacts == b.contacts &&
         a.backdrop == b.backdrop && a.skin_opacity == b.skin_opacity &&
         a.part_opacity == b.part_opacity;
}

}  // namespace

std::pair<int, int> Window::State::size() const {
  int w = 0, h = 0;
  glfwGetWindowSize(window, &w, &h);
  return {std::max(1, w), std::max(1, h)};
}

ViewRect Window::State::view_rect() const {
  const auto [w, h] = size();
  return panels->layout(w, h, view).view;
}

/// The camera in the cranium's frame, without the head's extension.
Camera Window::State::without_extension() const {
  return expressed_in(view.hands.X_RC(frame() ? frame()->poses[view.hands.jaw] : Pose{}).inverse(),
                      camera);
}

/// The camera in the cranium's frame, in which everything is drawn.
Camera Window::State::seen() const {
  const Camera still = without_extension();
  if (!view.look.life || !frame()) return still;
  const PictureSettings shown = settings();
  if (!shows_life(scene.parts, shown)) return still;
  const Pose X_CM = frame()->poses[lower_jaw_of(scene.parts)];
  return seeing_extension(still, *shown.life, life_signs(frame()->time_s, X_CM).extension);
}

/// Life needs pictures that compare nothing.
std::optional<Life> Window::State::life() const {
  const Look& look = view.look;
  if (!look.life || look.wipe || look.displacement || view.distances) return std::nullopt;
  Eigen::AlignedBox3d joints;
  std::optional<Eigen::Vector3d> nose_tip;
  for (const Landmark& landmark : view.landmarks) {
    if (landmark.name == "left_condyle" || landmark.name == "right_condyle")
      joints.extend(landmark.at_rest);
    if (landmark.name == "pronasale") nose_tip = landmark.at_rest;
  }
  return life_about(joints.isEmpty() ? box.center() : joints.center(), nose_tip);
}

PictureSettings Window::State::settings() const {
  const ViewRect rect = view_rect();
  int pixels = 0, ignored = 0;
  glfwGetFramebufferSize(window, &pixels, &ignored);
  const double density = std::max(1, pixels) / static_cast<double>(size().first);
  PictureSettings picture_settings;
  picture_settings.width = std::max(1, static_cast<int>(std::lround(rect.width * density)));
  picture_settings.height = std::max(1, static_cast<int>(std::lround(rect.height * density)));
  picture_settings.shadows = view.shadows;
  picture_settings.folds = view.look.folds;
  picture_settings.life = life();
  picture_settings.contacts = view.mark_contacts;
  picture_settings.backdrop = arrangement.light ? Backdrop::light : Backdrop::dark;
  picture_settings.skin_opacity = view.skin_opacity;
  picture_settings.part_opacity = part_opacities(scene, view);
  if (render_request.parts) apply_look(picture_settings);
  return picture_settings;
}

void Window::State::apply_look(PictureSettings& picture_settings) const {
  const Look& look = view.look;
  if (look.clip) {
    const Eigen::Vector3d low = box.min(), high = box.max();
    const std::string_view sides = "LRPASI";  // axes left, back, up: both directions
    const auto which = sides.find(look.clip_from);
    const auto axis = static_cast<Eigen::Index>(which / 2);
    const double sign = which % 2 == 0 ? 1 : -1;
    ClippingPlane plane;
    plane.normal = sign * Eigen::Vector3d::Unit(axis);
    const double from = sign > 0 ? high[axis] : low[axis];
    plane.point =
        Eigen::Vector3d::Unit(axis) * (from - sign * look.clip_fraction * (high - low)[axis]);
    if (look.clip_skin)
      for (const Part& part : scene.parts)
        if (part.role == Role::face) plane.parts.push_back(part.name);
    picture_settings.clip = plane;
  }
  if (look.cut_away) {
    constexpr std::array names = {"left_condyle", "right_condyle", "stomion"};
    const std::string name = names[static_cast<std::size_t>(look.cut_at)];
    for (const Landmark& landmark : view.landmarks)
      if (landmark.name == name)
        picture_settings.cut_away =
            CutAway{.center = landmark.at_rest, .radius_mm = look.cut_radius_mm};
  }
  if (look.ghost) picture_settings.ghost = Ghost{};
  if (look.wireframe) picture_settings.wireframe = {"*"};
  constexpr float touching_mm = 0.1f;
  if (look.patches && view.distances) picture_settings.mapped_up_to = touching_mm;
}

bool Window::State::moving() const {
  return view.playing || view.falling || input.held || input.drag != CameraDrag::none ||
         seconds_since(pacing.last_change) < calm_s;
}

double Window::State::screen_scale() const {
  float x = 1, y = 1;
  glfwGetWindowContentScale(window, &x, &y);
  return std::max(x, y);
}

float Window::State::panel_scale() const {
  const auto [w, h] = size();
  int pixels = 0, ignored = 0;
  glfwGetFramebufferSize(window, &pixels, &ignored);
  const double screen = screen_scale();
  return fitting_scale(screen * arrangement.ui_scale.value_or(default_scale(screen, pixels)), w, h);
}

void Window::State::fit_scale() {
  const float scale = panel_scale();
  const bool light = arrangement.light;
  if (scale == panels->theme().scale && light == panels->theme().light) return;
  panels->set_scale(scale);
  panels->set_light(light);
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

/// A tenth more or less than the displayed scale, so that each step up to the last has an effect.
void Window::State::scale_panels(Command command) {
  constexpr double step = 0.1, least = 0.5, most = 4;
  std::optional<double>& ui_scale = arrangement.ui_scale;
  const float before = panels->theme().scale;
  const double steps = command == Command::larger_panels ? 1 : -1;
  if (command == Command::default_panels)
    ui_scale = options.default_scale;
  else
    ui_scale = std::clamp(step * std::round(before / step + steps), least, most) / screen_scale();
  const float after = panel_scale();
  if (command == Command::larger_panels && after <= before) ui_scale = before / screen_scale();
  panels->say(fmt::format("Panels at {:.0f} %{}", 100 * panel_scale(),
                          command == Command::larger_panels && after <= before
                              ? ": no larger ones fit into this window"
                              : ""));
  noticed();
}

/// Uploads the pictures of a CT that have changed. Returns their textures; 0: none.
std::array<std::uintptr_t, 4> Window::State::show_ct_pictures() {
  std::array<std::uintptr_t, 4> names = {};
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::shared_ptr<const CtPixels> pixels;
    if (scene.ct) pixels = i < 3 ? scene.ct->slices[i].picture : scene.ct->solid;
    std::optional<CtTexture>& shown = ct_textures[i];
    if (!pixels) {
      shown.reset();
      continue;
    }
    if (!shown) shown.emplace();
    if (shown->pixels != pixels) {
      pacing.draw(
          [&] { shown->texture.upload(pixels->width, pixels->height, pixels->rgba.data()); });
      shown->pixels = std::move(pixels);
    }
    names[i] = shown->texture.name();
  }
  return names;
}

void Window::State::interface_frame() {
  fit_scale();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  // The backend only has the mouse's present position; the queue has each press with its position,
  // and likewise each key. Typed characters are processed first: they belong to a field that was
  // clicked before, and a click on a button beside the field requires its complete text.
  const bool look_at_mouse = input.keys.empty();
  if (look_at_mouse) input.mouse_shown = input.mouse.take();
  // The panels have received the press and the release of the click that opens a menu.
  if (input.menu && !input.mouse.waiting())
    panels->open_part_menu(*std::exchange(input.menu, std::nullopt));
  const MouseMoment& moment = input.mouse_shown;
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = {static_cast<float>(moment.x), static_cast<float>(moment.y)};
  io.MouseDrawCursor = input.replayed;
  if (input.replayed) io.MouseWheel = std::exchange(input.replayed_wheel, 0.f);
  for (std::size_t i = 0; i < moment.down.size(); ++i) io.MouseDown[i] = moment.down[i];
  if (!input.keys.empty()) {
    const WindowInput::KeyMoment next = input.keys.front();
    input.keys.pop_front();
    if (next.letter) {
      io.KeyCtrl = io.KeyShift = false;
      io.AddInputCharacter(next.letter);
    } else {
      io.KeysDown[next.key] = next.down;
      // Modifiers held besides this key, and the key itself: at its release GLFW still reports it
      // as held.
      const auto held_now = [&](int mod, int left_key, int right_key) {
        const bool itself = next.key == left_key || next.key == right_key;
        return itself ? next.down : (next.mods & mod) != 0;
      };
      io.KeyCtrl = held_now(GLFW_MOD_CONTROL, GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL);
      io.KeyShift = held_now(GLFW_MOD_SHIFT, GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT);
    }
  }
  const bool ctrl_of_keys = io.KeyCtrl, shift_of_keys = io.KeyShift;
  if (look_at_mouse && moment.ctrl) io.KeyCtrl = true;
  if (look_at_mouse && moment.shift) io.KeyShift = true;
  ImGui::NewFrame();
  const auto [w, h] = size();
  const ViewRect r = view_rect();
  if (drawn()) {
    const ImVec2 low = {static_cast<float>(r.x), static_cast<float>(r.y)};
    const ImVec2 high = {static_cast<float>(r.x + r.width), static_cast<float>(r.y + r.height)};
    // GL keeps the first row at the bottom.
    ImGui::GetBackgroundDrawList()->AddImage(
        reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture->name())), low, high,
        {0, 1}, {1, 0});
  }
  const auto seen_places =
      frame() ? displayed_face.places(*frame()) : std::vector<Eigen::Vector3f>();
  const PanelInput shown{
      .scene = scene,
      .frame = frame(),
      .displayed_face = seen_places,
      .loop = loop,
      .pictures = pacing.pictures,
      .camera = seen(),
      .box = box,
      .progress = work.progress.empty() && render_request.parts && !drawn() && !cannot_draw
                      ? std::string(preparing)
                      : work.progress,
      .progress_fraction = work.progress_fraction,
      .can_cancel = work.can_cancel,
      .key = overlays.key,
      .labels = overlays.labels,
      .hover_text = hover_text(),
      .plots = plots,
      .kept = comparison.by_hand,
      .recording = !work.recording.empty(),
      .recording_what = work.recording,
      .recording_fraction = work.recording_fraction,
      .unfinished = work.unfinished,
      .recording_folder = options.recording_folder,
      .recording_folder_name = options.recording_folder_name,
      .file_dialog = options.file_dialog,
      .ct_pictures = show_ct_pictures()};
  const std::vector<Command> commands = panels->draw(shown, view, w, h);
  ImGui::Render();
  io.KeyCtrl = ctrl_of_keys;
  io.KeyShift = shift_of_keys;
  for (const Command command : commands) run(command);
}

/// Text for the part under the mouse and its distance, while distances are shown.
std::string Window::State::hover_text() const {
  const MouseMoment& now = input.mouse.now();
  if (!view.distances || !render_request.values || !render_request.map ||
      input.drag != CameraDrag::none || !over_view(now.x, now.y))
    return {};
  if (view.shows_face(scene) && view.skin_opacity > seen_through) return {};
  std::vector<PickableSurface> surfaces;
  std::vector<std::size_t> parts;
  const auto& finer = render_request.map->surfaces;
  for (std::size_t i = 0; i < std::min(finer.size(), render_request.values->size()); ++i) {
    const std::size_t part = finer[i].part;
    if (part >= view.parts.size() || !view.parts[part].shown ||
        view.parts[part].opacity <= seen_through)
      continue;
    surfaces.push_back(
        {finer[i].mesh, pose_of(scene.parts[part], frame()->poses), (*render_request.values)[i]});
    parts.push_back(part);
  }
  const auto found = pick_value(seen(), view_rect(), {now.x, now.y}, surfaces);
  if (!found) return {};
  const std::string name = display_name(scene.parts[parts[found->surface]].name);
  const ColourMap& map = *scene.distance_colours;
  if (!(found->value < map.high())) return fmt::format("{}: more than {:g} mm", name, map.high());
  if (std::isinf(found->value)) return fmt::format("{}: deep inside", name);
  if (found->value < 0) return fmt::format("{}: {:.2f} mm inside", name, -found->value);
  return fmt::format("{}: {:.2f} mm", name, found->value);
}

bool Window::State::drawn() const {
  return render_request.parts && texture->parts() == render_request.parts;
}

/// Requests a picture of the present state.
void Window::State::request_picture() {
  if (!render_request.parts) return;
  render_request.camera = seen();
  render_request.settings = settings();
  render_request.moving = moving();
  render_request.quality = pacing.governor.choose(render_request.moving);
  render_request.beside = view.look.wipe && render_request.frame ? comparison.frame : nullptr;
  render_request.before_is_beside = comparison.before != nullptr;
  render_request.wipe_at = view.look.wipe_at;
  render_request.beside_values = render_request.beside ? comparison.values : nullptr;
  render_request.displacement = view.look.displacement;
  if (overlays_due) render_request.overlays = std::make_shared<Overlays>(overlays);
  overlays_due = false;
  ++render_request.number;
  pacing.last_request = Clock::now();
  render_thread->request(render_request);
  pacing.pictures.finished = false;
  requested_look = view.look;
  pacing.scene_changed = false;  // also on failure: the next change tries again
}

/// Shows the newest picture, if any. Returns whether there was one.
bool Window::State::take_picture() {
  const auto picture = render_thread->take();
  if (!picture || picture->parts != render_request.parts) return false;
  pacing.draw([&] { texture->show(*picture); });
  cannot_draw = false;
  pacing.governor.measured(picture->moving, picture->ms);
  pacing.pictures.picture_ms = picture->ms;
  // On a fast machine the moving picture already has full quality: no other follows.
  pacing.pictures.finished = picture->number == render_request.number && !pacing.scene_changed &&
                             picture->quality == pacing.governor.choose(false);
  pacing.pictures.render_scale = picture->quality.render_scale;
  pacing.pictures.samples = picture->samples;
  // The rate of pictures is meaningful only during motion.
  const double counted_s = seconds_since(pacing.counted_from);
  ++pacing.counted_pictures;
  if (picture->moving && counted_s < 0.5) return true;
  pacing.pictures.pictures_per_second =
      picture->moving && counted_s < 2 ? pacing.counted_pictures / counted_s : 0;
  pacing.counted_pictures = 0;
  pacing.counted_from = Clock::now();
  return true;
}

void Window::State::draw(bool always, Image* copy) {
  if (render_request.parts &&
      (!(view.look == requested_look) || !same(settings(), render_request.settings) ||
       !same(seen(), render_request.camera))) {
    pacing.scene_changed = true;
    pacing.last_change = Clock::now();
  }
  const bool yields = view.playing && input.drag == CameraDrag::none &&
                      seconds_since(pacing.last_request) < pacing.governor.min_interval_s();
  if (render_request.parts && !yields &&
      (pacing.scene_changed || !(pacing.governor.choose(moving()) == render_request.quality)))
    request_picture();
  bool news = false;
  try {
    news = take_picture();
  } catch (const std::exception& error) {
    if (render_thread->lacks_context() && lend_context()) {
      request_picture();
    } else {
      cannot_draw = true;
      panels->report_error({"Cannot draw the picture", error.what()});
      pacing.frames_due = 3;
    }
  }
  while (const auto saved = render_thread->take_saved()) {
    if (saved->trouble.empty())
      panels->say("Saved " + std::filesystem::absolute(saved->file).lexically_normal().string());
    else
      panels->report_error({"Cannot save the picture", saved->trouble});
    pacing.frames_due = 3;
  }
  const bool clock_due = view.playing && seconds_since(pacing.last_draw) > clock_interval_s;
  const bool due = news || pacing.frames_due > 0 || clock_due || save_window || panels->talking();
  // Slightly early counts as due: the wait before was for this picture.
  if (!always &&
      (!due || pacing.drawn || seconds_since(pacing.last_draw) < 0.9 * picture_interval_s)) {
    if (news) pacing.frames_due = std::max(pacing.frames_due, 1);
    return;
  }
  pacing.last_draw = Clock::now();
  pacing.drawn = true;
  interface_frame();

  pacing.draw([&] {
    int w = 0, h = 0;
    glfwGetFramebufferSize(window, &w, &h);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, w, h);
    const ImVec4 back = ImGui::ColorConvertU32ToFloat4(palette().window);
    glClearColor(back.x, back.y, back.z, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  });
  pacing.draw([&] {
    if (copy) *copy = read_back();
    if (std::exchange(save_window, false)) render_thread->save(read_back(), options.picture_folder);
  });
  pacing.draw([&] { glfwSwapBuffers(window); });
  pacing.frames_due = std::max(0, pacing.frames_due - 1);
}

Image Window::State::read_back() const {
  Image image;
  glfwGetFramebufferSize(window, &image.width, &image.height);
  const std::size_t stride = std::size_t{4} * static_cast<std::size_t>(image.width);
  std::vector<std::uint8_t> rows(stride * static_cast<std::size_t>(image.height));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, rows.data());
  for (std::size_t i = 3; i < rows.size(); i += 4) rows[i] = 255;
  image.rgba.reserve(rows.size());
  for (std::size_t row = static_cast<std::size_t>(image.height); row-- > 0;)
    image.rgba.insert(image.rgba.end(), rows.begin() + static_cast<std::ptrdiff_t>(row * stride),
                      rows.begin() + static_cast<std::ptrdiff_t>((row + 1) * stride));
  return image;
}

}  // namespace condyle
