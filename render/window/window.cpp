#include "render/window/window.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.h"
#include "render/window/view/playback.h"
#include "render/window/window_state.h"

namespace condyle {

namespace {

constexpr int min_window_width = 800, min_window_height = 500;  // required by the panels

void ask_for_opengl() {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
}

/// The screen may be smaller than in the last run.
void fit_to_screen(int& width, int& height) {
  GLFWmonitor* monitor = glfwGetPrimaryMonitor();
  if (!monitor) return;
  int x = 0, y = 0, wide = 0, high = 0;
  glfwGetMonitorWorkarea(monitor, &x, &y, &wide, &high);
  float scale_x = 1, scale_y = 1;
  glfwGetMonitorContentScale(monitor, &scale_x, &scale_y);
  if (wide > 0) width = std::min(width, static_cast<int>(static_cast<float>(wide) / scale_x));
  if (high > 0) height = std::min(height, static_cast<int>(static_cast<float>(high) / scale_y));
}

/// What a scene draws.
std::shared_ptr<const DrawnParts> drawn_parts(const WindowScene& scene,
                                              std::shared_ptr<const void> keeper) {
  return std::make_shared<DrawnParts>(
      DrawnParts{scene.parts, scene.distance_colours, scene.before, std::move(keeper)});
}

}  // namespace

Window::State::State(const WindowOptions& given) : options(given), arrangement(given.arrangement) {
  static_cast<PanelChoice&>(view) = arrangement.panels;
  if (options.fit_screen) fit_to_screen(arrangement.width, arrangement.height);
  ask_for_opengl();
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  glfwWindowHint(GLFW_SAMPLES, 0);  // the 3-D view has its own
  glfwWindowHint(GLFW_MAXIMIZED, arrangement.maximized ? GLFW_TRUE : GLFW_FALSE);
  window = glfwCreateWindow(std::max(1, arrangement.width), std::max(1, arrangement.height),
                            options.title.c_str(), nullptr, nullptr);
  if (!window) {
    const std::string words = take_glfw_error();
    throw MachineError("the display has no window with OpenGL 3.3 (" +
                       (words.empty() ? "no reason given" : words) +
                       "); install libgl1-mesa-dri or the graphics card's driver. Pictures and "
                       "films need no window: condyle record --motion opening --out DIR");
  }
  glfwSetWindowSizeLimits(window, min_window_width, min_window_height, GLFW_DONT_CARE,
                          GLFW_DONT_CARE);
  glfwMakeContextCurrent(window);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(window, this);
  install_callbacks();

  imgui = ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // write no files
  ImGui::GetIO().LogFilename = nullptr;
  panels.emplace(1.0f, arrangement.light);
  panels->arrange(arrangement.sizes, arrangement.open_groups, arrangement.record);
  texture.emplace();
  render_thread.emplace([] { Window::wake(); });
  ImGui_ImplGlfw_InitForOpenGL(window, true);  // calls our callbacks before its own
  install_key_callbacks();
  ImGui_ImplOpenGL3_Init("#version 330 core");
  const double asked = screen_scale() * arrangement.ui_scale.value_or(0);
  if (options.default_scale && panel_scale() < asked - 0.005)
    panels->say(fmt::format("Panels at {:.0f} %: {:.0f} % do not fit into this window",
                            100 * panel_scale(), 100 * asked));
}

Window::State::~State() {
  if (window) glfwHideWindow(window);  // hidden at once, even while a picture is being drawn
  render_thread.reset();
  ct_textures = {};
  texture.reset();
  if (imgui) {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext(imgui);
  }
  if (spare) glfwDestroyWindow(spare);
  if (window) glfwDestroyWindow(window);
}

/// Gives the render_thread, which found no context through EGL, one of the display. Returns whether
/// there is one.
bool Window::State::lend_context() {
  if (spare) return false;
  glfwDefaultWindowHints();
  ask_for_opengl();
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  spare = glfwCreateWindow(16, 16, "", nullptr, nullptr);
  if (!spare) return false;
  render_thread->use_context([lent = spare] {
    glfwMakeContextCurrent(lent);
    if (glfwGetCurrentContext() != lent)
      throw MachineError("the display lends no OpenGL context to draw pictures with");
    return std::shared_ptr<void>(lent, [](void*) { glfwMakeContextCurrent(nullptr); });
  });
  return true;
}

Window::Window(const WindowOptions& options) : state_(std::make_unique<State>(options)) {}
Window::~Window() = default;

/// Shows other parts, without what the window knows of the earlier ones.
void Window::change_parts(const WindowScene& scene, const ViewState& start,
                          std::shared_ptr<const void> keeper) {
  State& s = *state_;
  s.scene = scene;
  s.displayed_face = DisplayedFace(scene.parts);
  s.view = start;
  s.view.fit(scene);
  s.render_request = {.number = s.render_request.number};
  s.comparison.before = scene.before;
  s.comparison.frame.reset();
  if (scene.before) s.comparison.frame = {scene.before, &scene.before->frame};
  s.comparison.by_hand = false;
  s.comparison.values.reset();
  s.cannot_draw = false;
  if (!scene.parts.empty()) s.render_request.parts = drawn_parts(scene, std::move(keeper));
  s.box.setEmpty();
  for (const Part& part : scene.parts)
    for (const auto& vertex : part.mesh.vertices) s.box.extend(vertex);
  if (s.box.isEmpty()) s.box.extend(Eigen::Vector3d::Zero());
  s.input.held.reset();
  s.plots.clear();
  s.overlays = {};
  s.overlays_due = true;
  s.view.landmarks = scene.landmarks;
  s.view.motion = scene.motion;
  s.pacing.scene_changed = true;
}

void Window::set_scene(const WindowScene& scene, const ViewState& start,
                       std::shared_ptr<const void> keeper) {
  State& s = *state_;
  change_parts(scene, start, std::move(keeper));
  s.panels->forget_patient();
  glfwSetWindowTitle(s.window, scene.case_name.empty()
                                   ? s.options.title.c_str()
                                   : (scene.case_name + " - " + s.options.title).c_str());
  s.fit_scale();
  s.set_standard_view(camera_of(Command::reset_view));
  s.noticed();
}

void Window::replace_scene(const WindowScene& scene, const ViewState& start,
                           std::shared_ptr<const void> keeper, bool new_parts) {
  change_parts(scene, start, std::move(keeper));
  if (new_parts) state_->panels->forget_edits();
  state_->noticed();
}

bool Window::open() const { return !glfwWindowShouldClose(state_->window); }

void Window::close() { glfwSetWindowShouldClose(state_->window, GLFW_TRUE); }

void Window::keep_open() { glfwSetWindowShouldClose(state_->window, GLFW_FALSE); }

const ViewState& Window::poll() {
  State& s = *state_;
  s.wait_for_events();
  const double elapsed = std::min(0.25, seconds_since(s.pacing.last_poll));
  s.pacing.last_poll = State::Clock::now();
  if (s.view.playing) {
    advance_clock(s.view, elapsed, s.scene.duration_s, s.frame() ? s.frame()->time_s : 0);
  }
  return s.view;
}

void Window::set_map_surfaces(std::vector<MapSurface> surfaces,
                              std::shared_ptr<const void> keeper) {
  State& s = *state_;
  s.render_request.map =
      std::make_shared<DrawnMap>(DrawnMap{std::move(surfaces), std::move(keeper)});
  s.pacing.scene_changed = true;
}

void Window::show(FrameState frame, const LoopStatistics& loop, MapValues values) {
  State& s = *state_;
  const FrameState* before = s.frame();
  const bool same = before && before->time_s == frame.time_s &&
                    before->state_hash == frame.state_hash && before->lids == frame.lids &&
                    before->face.size() == frame.face.size();
  if (s.loop.message != loop.message) s.pacing.frames_due = std::max(s.pacing.frames_due, 1);
  s.loop = loop;
  s.pacing.governor.simulated(loop.steps_per_second);
  if (s.render_request.values ? values != *s.render_request.values : !values.empty()) {
    s.render_request.values =
        values.empty() ? nullptr : std::make_shared<MapValues>(std::move(values));
    s.pacing.scene_changed = true;
  }
  if (!same) {
    s.render_request.frame = std::make_shared<FrameState>(std::move(frame));
    if (!s.comparison.frame) s.comparison.frame = s.render_request.frame;
    s.pacing.last_change = State::Clock::now();
    s.pacing.scene_changed = true;
  }
  s.draw(false);
}

void Window::draw() { state_->draw(false); }

void Window::renew_scene(const WindowScene& scene, std::shared_ptr<const void> keeper) {
  State& s = *state_;
  s.render_request.parts = drawn_parts(scene, std::move(keeper));
  s.render_request.map.reset();
  s.render_request.values.reset();
  s.comparison.values.reset();
  s.input.held.reset();
  s.pacing.scene_changed = true;
  s.displayed_face = DisplayedFace(scene.parts);
  update_scene(scene);
}

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

std::vector<Request> Window::take_requests() {
  State& s = *state_;
  auto requests = s.panels->take_requests();
  for (Request& one : requests)
    if (auto* record = std::get_if<request::Record>(&one)) {
      record->picture = s.settings();
      record->camera = s.without_extension();
      const Pose X_RC = s.view.hands.X_RC(s.frame() ? s.frame()->poses[s.view.hands.jaw] : Pose{});
      record->upright = X_RC.R.conjugate() * Eigen::Vector3d::UnitZ();
      if (s.view.look.wipe) {
        record->kept = s.comparison.frame;
        record->before = s.comparison.before;
      }
    }
  if (!s.input.dropped.empty())
    requests.push_back(request::Open{std::exchange(s.input.dropped, {})});
  return requests;
}

void Window::ask_roles(const request::Import& files) {
  state_->panels->ask_roles(files);
  state_->noticed();
}

void Window::ask(Question question) {
  state_->panels->ask(std::move(question));
  state_->noticed();
}

const Question* Window::question() const { return state_->panels->question(); }

void Window::show_plots(std::vector<PlotSet> plots) {
  state_->plots = std::move(plots);
  if (state_->view.plots) state_->pacing.frames_due = std::max(state_->pacing.frames_due, 1);
}

void Window::show_overlays(Overlays overlays) {
  state_->overlays = std::move(overlays);
  state_->overlays_due = state_->pacing.scene_changed = true;
}

void Window::show_progress(const std::string& what, double fraction, bool can_cancel) {
  State& s = *state_;
  if (what == s.work.progress && std::abs(fraction - s.work.progress_fraction) < 0.005 &&
      can_cancel == s.work.can_cancel)
    return;
  s.work.progress = what;
  s.work.progress_fraction = fraction;
  s.work.can_cancel = can_cancel;
  s.pacing.frames_due = std::max(s.pacing.frames_due, 1);
}

void Window::show_recording(const std::string& what, double fraction) {
  State& s = *state_;
  if (what == s.work.recording && fraction == s.work.recording_fraction) return;
  s.work.recording = what;
  s.work.recording_fraction = fraction;
  s.pacing.frames_due = std::max(s.pacing.frames_due, 1);
}

void Window::show_unfinished(const std::string& sentence) {
  state_->work.unfinished = sentence;
  state_->noticed();
}

void Window::say(const std::string& sentence) {
  state_->panels->say(sentence);
  state_->noticed();
}

void Window::report_error(const std::string& title, const std::string& sentence) {
  state_->panels->report_error({title, sentence});
  state_->noticed();
}

void Window::wake() { glfwPostEmptyEvent(); }

const ViewState& Window::view() const { return state_->view; }
const WindowScene& Window::scene() const { return state_->scene; }
const std::string& Window::said() const { return state_->panels->said(); }
std::string Window::trouble() const { return state_->panels->trouble().sentence; }
const Camera& Window::camera() const { return state_->camera; }
void Window::set_camera(const Camera& camera) {
  state_->camera = camera;
  state_->pacing.scene_changed = true;
}
void Window::set_record_folder(const std::filesystem::path& folder) {
  state_->panels->set_record_folder(folder);
  state_->noticed();
}
const PictureStatistics& Window::pictures() const { return state_->pacing.pictures; }
const std::vector<DrawnItem>& Window::items() const { return state_->panels->items(); }
ViewRect Window::view_rect() const { return state_->view_rect(); }

Arrangement Window::arrangement() const {
  const State& s = *state_;
  Arrangement now = s.arrangement;
  now.sizes = s.panels->sizes();
  now.open_groups = s.panels->open_groups();
  now.record = s.panels->record_choice();
  now.panels = s.view;
  return now;
}

Image Window::picture() {
  Image image;
  state_->request_picture();
  state_->render_thread->finish();
  state_->draw(true, &image);
  return image;
}

}  // namespace condyle
