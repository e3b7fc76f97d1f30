#include "render/window/window.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.h"
#include "render/window/playback.h"
#include "render/window/window_state.h"

namespace condyle {

Window::State::State(const WindowOptions& wanted) : options(wanted) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  glfwWindowHint(GLFW_SAMPLES, 0);  // the 3-D view has its own
  window = glfwCreateWindow(std::max(1, options.width), std::max(1, options.height),
                            options.title.c_str(), nullptr, nullptr);
  if (!window) {
    const std::string words = take_glfw_error();
    throw MachineError("the display gives no window with OpenGL 3.3 (" +
                       (words.empty() ? "no reason given" : words) +
                       "); install libgl1-mesa-dri or the graphics card's driver. Pictures and "
                       "films need no window: condyle record --motion opening --out DIR");
  }
  glfwSetWindowSizeLimits(window, 640, 400, GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwMakeContextCurrent(window);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(window, this);
  install_callbacks();

  imgui = ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // leave no files behind
  ImGui::GetIO().LogFilename = nullptr;
  panels.emplace(1.0f, options.light);
  view_picture.emplace();
  ImGui_ImplGlfw_InitForOpenGL(window, true);  // calls our callbacks before its own
  install_key_callbacks();
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::State::~State() {
  renderer.reset();
  view_picture.reset();
  if (imgui) {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext(imgui);
  }
  if (window) glfwDestroyWindow(window);
}

Window::Window(const WindowOptions& options) : state_(std::make_unique<State>(options)) {}
Window::~Window() = default;

void Window::set_scene(const WindowScene& scene, const ViewState& start) {
  State& s = *state_;
  s.renderer.reset();
  s.scene = scene;
  s.view = start;
  s.view.parts.resize(scene.parts.size());
  s.has_frame = s.frame_new = false;
  s.frame = {};
  s.map_surfaces.clear();
  s.values.clear();
  s.held.reset();
  s.plots.clear();
  s.lines.clear();
  s.lines_new = true;
  s.view.landmarks = scene.landmarks;
  s.view.motion = scene.motion;
  s.panels->forget_edits();
  if (!scene.parts.empty()) s.renderer.emplace(scene.parts);
  if (s.renderer && scene.distance_colours) s.renderer->set_colour_map(*scene.distance_colours);
  s.fit_scale();
  s.set_standard_view(camera_of(Command::reset_view));
  s.noticed();
}

bool Window::open() const { return !glfwWindowShouldClose(state_->window); }

const ViewState& Window::poll() {
  State& s = *state_;
  s.wait_for_events();
  const double elapsed = std::min(0.25, seconds_since(s.last_poll));
  s.last_poll = State::Clock::now();
  if (s.view.playing) {
    advance_clock(s.view, elapsed, s.scene.duration_s, s.has_frame ? s.frame.time_s : 0);
    s.frames_due = std::max(s.frames_due, 1);
  }
  return s.view;
}

void Window::set_map_surfaces(std::vector<MapSurface> surfaces) {
  State& s = *state_;
  s.map_surfaces = std::move(surfaces);
  for (const auto& surface : s.map_surfaces)
    s.renderer->set_finer(s.scene.parts[surface.part].name, *surface.mesh, surface.normals);
}

void Window::show(FrameState frame, const LoopStatistics& loop,
                  std::vector<std::vector<float>> values) {
  State& s = *state_;
  const bool same = s.has_frame && s.frame.time_s == frame.time_s &&
                    s.frame.state_hash == frame.state_hash &&
                    s.frame.face.size() == frame.face.size();
  if (s.loop.message != loop.message) s.frames_due = std::max(s.frames_due, 1);
  s.loop = loop;
  if (values != s.values) {
    s.values = std::move(values);
    s.values_new = true;
    s.frames_due = std::max(s.frames_due, 1);
  }
  if (!same) {
    if (!s.has_frame) s.kept = frame;
    s.frame = std::move(frame);
    s.has_frame = s.frame_new = true;
    s.last_change = State::Clock::now();
    s.frames_due = std::max(s.frames_due, 1);
  }
  s.draw(false);
}

void Window::draw() { state_->draw(false); }

void Window::update_scene(const WindowScene& scene) {
  State& s = *state_;
  const bool other_motion = !(scene.motion == s.scene.motion);
  s.scene = scene;
  s.view.motion = scene.motion;
  if (other_motion) s.view.time_s = 0;
  s.view.time_s = std::min(s.view.time_s, scene.duration_s);
  s.noticed();
}

void Window::change(const std::function<void(ViewState&)>& edit, bool remember) {
  State& s = *state_;
  if (remember) s.panels->remember(s.view);
  edit(s.view);
  s.noticed();
}

std::vector<Wish> Window::take_wishes() {
  State& s = *state_;
  auto wishes = s.panels->take_wishes();
  for (Wish& one : wishes)
    if (auto* record = std::get_if<wish::Record>(&one)) record->picture = s.settings();
  if (!s.dropped.empty()) wishes.push_back(wish::Open{std::exchange(s.dropped, {})});
  return wishes;
}

void Window::ask_roles(const wish::Import& files) {
  state_->panels->ask_roles(files);
  state_->noticed();
}

void Window::show_plots(std::vector<PlotSet> plots) {
  state_->plots = std::move(plots);
  if (state_->view.plots) state_->frames_due = std::max(state_->frames_due, 1);
}

void Window::show_lines(const std::string& name, LineSet lines) {
  state_->lines[name] = std::move(lines);
  state_->lines_new = true;
  state_->frames_due = std::max(state_->frames_due, 1);
}

void Window::show_progress(const std::string& what, double fraction, bool can_cancel) {
  State& s = *state_;
  if (what == s.progress && std::abs(fraction - s.progress_fraction) < 0.005 &&
      can_cancel == s.can_cancel)
    return;
  s.progress = what;
  s.progress_fraction = fraction;
  s.can_cancel = can_cancel;
  s.frames_due = std::max(s.frames_due, 1);
}

void Window::show_recording(const std::string& what, double fraction) {
  State& s = *state_;
  if (what == s.recording && fraction == s.recording_fraction) return;
  s.recording = what;
  s.recording_fraction = fraction;
  s.frames_due = std::max(s.frames_due, 1);
}

void Window::say(const std::string& sentence) {
  state_->panels->say(sentence);
  state_->noticed();
}

void Window::report_error(const std::string& sentence) {
  state_->panels->report_error(sentence);
  state_->noticed();
}

void Window::wake() { glfwPostEmptyEvent(); }

const ViewState& Window::view() const { return state_->view; }
const Camera& Window::camera() const { return state_->camera; }
void Window::set_camera(const Camera& camera) {
  state_->camera = camera;
  state_->scene_changed = true;
}
const PictureStatistics& Window::pictures() const { return state_->pictures; }
const std::vector<DrawnItem>& Window::items() const { return state_->panels->items(); }
ViewRect Window::view_rect() const { return state_->view_rect(); }

Image Window::picture() {
  Image image;
  state_->draw(true, &image);
  return image;
}

}  // namespace condyle
