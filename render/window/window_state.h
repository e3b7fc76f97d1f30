#pragma once

#include <GLFW/glfw3.h>
#include <epoxy/gl.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "render/window/glfw_session.h"
#include "render/window/input/clicks.h"
#include "render/window/input/gizmos.h"
#include "render/window/input/mouse_queue.h"
#include "render/window/input/picking.h"
#include "render/window/picture/displayed_face.h"
#include "render/window/picture/image_texture.h"
#include "render/window/picture/picture_texture.h"
#include "render/window/picture/quality.h"
#include "render/window/picture/render_thread.h"
#include "render/window/view/part_menu.h"
#include "render/window/window.h"

struct ImGuiContext;

namespace condyle {

/// The state shown left of the wipe: the first frame, or the one that the user kept.
struct WindowComparison {
  std::shared_ptr<const FrameState> frame;
  bool by_hand = false;
  std::shared_ptr<const BeforeOperation> before;  // the operation, where the frame is its own
  std::shared_ptr<const MapValues> values;        // its distances; none if they were not shown
};

/// A picture of a CT, and the pixels that it has.
struct CtTexture {
  ImageTexture texture;
  std::shared_ptr<const CtPixels> pixels;
};

/// Background work and recordings, as the panels report them.
struct WorkProgress {
  std::string progress, recording, unfinished;
  double progress_fraction = 0, recording_fraction = 0;
  bool can_cancel = false;
};

/// Mouse and keyboard events not yet processed by the panels, and what is dragged.
struct WindowInput {
  /// Keys and letters for a text field, in order, each with its own pass over the panels.
  struct KeyMoment {
    int key = 0;
    bool down = false;
    int mods = 0;
    unsigned letter = 0;  // typed character; 0: a key
  };
  /// A body moved by hand, with its state at the moment of the grip.
  struct Held {
    Grip grip;
    std::size_t body;
    GizmoView view;
    Pose start;  // in the cranium's frame; of the skull in the world's
    Eigen::Vector2d from;
  };

  MouseQueue mouse;
  MouseMoment mouse_shown;  // given to the panels
  std::deque<KeyMoment> keys;
  CameraDrag drag = CameraDrag::none;
  int drag_button = -1;
  ClickDetector clicks;
  std::optional<PartMenu> menu;  // to be opened
  std::optional<Held> held;
  Eigen::Vector2d gripped_at = Eigen::Vector2d::Zero();  // where a handle of a cut was gripped
  std::vector<std::filesystem::path> dropped;            // onto the window, not taken yet
  bool replayed = false;                                 // the events are those of a replay
  float replayed_wheel = 0;                              // clicks that the panels have not received

  bool waits() const { return mouse.waiting() || !keys.empty(); }
};

/// Schedule and quality of pictures and panels.
struct WindowPacing {
  using Clock = std::chrono::steady_clock;

  QualityGovernor governor;
  PictureStatistics pictures;
  bool scene_changed = true;  // the last request is outdated
  int frames_due = 3;         // passes over the panels still to draw
  int counted_pictures = 0;   // since counted_from
  bool polled = false;        // whether events have been polled
  bool drawn = false;         // since then
  double drawing_s = 0;       // time in OpenGL since then
  Clock::time_point last_request{};
  Clock::time_point last_poll = Clock::now(), last_look = last_poll, last_draw = last_poll,
                    last_change = last_poll, last_event = last_poll, counted_from = last_poll;

  /// Calls OpenGL and counts the time.
  void draw(const std::function<void()>& calls) {
    const Clock::time_point start = Clock::now();
    calls();
    drawing_s += std::chrono::duration<double>(Clock::now() - start).count();
  }
  /// Called when the window is about to read mouse and keyboard.
  void note_time_away() {
    if (!std::exchange(polled, true)) return;
    const double away_s = std::chrono::duration<double>(Clock::now() - last_look).count();
    pictures.longest_away_ms = std::max(pictures.longest_away_ms, 1e3 * away_s);
    pictures.longest_work_ms = std::max(pictures.longest_work_ms, 1e3 * (away_s - drawing_s));
  }
  /// Called when it has read them.
  void note_look() {
    last_look = Clock::now();
    drawn = false;
    drawing_s = 0;
  }
  /// Called at an event: ImGui needs some passes to update what is hovered and held.
  void noticed() {
    frames_due = 3;
    last_event = Clock::now();
  }
};

/// The members of a Window. Only for window*.cpp.
struct Window::State {
  using Clock = std::chrono::steady_clock;

  explicit State(const WindowOptions& options);
  ~State();

  // In order of construction; destroyed in reverse order.
  GlfwSession session;
  GLFWwindow* window = nullptr;
  ImGuiContext* imgui = nullptr;
  std::optional<Panels> panels;
  std::optional<PictureTexture> texture;
  std::array<std::optional<CtTexture>, 4> ct_textures;  // three slices and the solid
  GLFWwindow* spare =
      nullptr;  // invisible: provides a context to the render_thread where EGL has none
  std::optional<RenderThread> render_thread;

  WindowOptions options;
  Arrangement arrangement;  // theme, scale and size; the rest is kept by the panels
  WindowScene scene;
  DisplayedFace displayed_face{scene.parts};
  ViewState view;
  Eigen::AlignedBox3d box;  // of the scene at rest
  Camera camera;            // in the world frame, in which the skull may have been moved
  ZoomLimits zoom;
  std::vector<PlotSet> plots;
  LoopStatistics loop;

  RenderRequest render_request;  // the newest picture that was requested
  Look requested_look;
  Overlays overlays;
  bool overlays_due = true;  // changed since the last request
  bool cannot_draw = false;  // the last picture failed
  bool save_window = false;

  WindowComparison comparison;
  WorkProgress work;
  WindowInput input;
  WindowPacing pacing;

  // window_input.cpp
  void install_callbacks();
  void install_key_callbacks();
  void on_key(int key, int mods);
  void on_button(int button, bool down, int mods);
  void on_move(double x, double y);
  void on_wheel(double clicks);
  bool over_view(double x, double y) const;
  void run(Command command);
  void note_size();
  void set_standard_view(std::string_view name);
  void wait_for_events();
  /// catch_errors() for the user's mouse and keyboard, which are ignored during a replay.
  template <class Work>
  static void catch_user(GLFWwindow* w, Work&& handle) {
    catch_errors(w, [&](State& state) {
      if (!state.input.replayed) handle(state);
    });
  }
  /// GLFW is C: nothing may be thrown through it.
  template <class Work>
  static void catch_errors(GLFWwindow* w, Work&& handle) {
    State& state = *static_cast<State*>(glfwGetWindowUserPointer(w));
    state.noticed();
    try {
      handle(state);
    } catch (const std::exception& error) {
      state.panels->report_error({"Cannot do this", error.what()});
    }
  }
  void noticed() { pacing.noticed(); }

  // window_replay.cpp
  void end_replay();
  void take_event(const input_event::Pointer& event) { on_move(event.x, event.y); }
  void take_event(const input_event::Button& event) { on_button(event.button, event.down, 0); }
  void take_event(const input_event::Wheel& event);
  void take_event(const input_event::Key& event);
  void take_event(const input_event::Letter& event);

  // window_picking.cpp
  std::optional<PickedPoint> surface_under(const Eigen::Vector2d& at, bool with_face) const;
  std::optional<PickedPoint> surface_of(const Eigen::Vector2d& at, bool glass) const;
  void on_click(const ClickDetector::Click& click);
  void focus(std::size_t part);

  // window_cutting.cpp
  std::optional<Eigen::Vector3d> cut_point(const Eigen::Vector2d& at, std::size_t part) const;
  void add_cut_point(const Eigen::Vector2d& at);
  bool grip_handle(const Eigen::Vector2d& at);
  void move_handle(const Eigen::Vector2d& at);
  void release_handle();

  // window_moving.cpp
  bool set_point(const Eigen::Vector2d& at);
  bool grip_body(const Eigen::Vector2d& at);
  void move_body(const Eigen::Vector2d& at);
  bool choose_axis(int key);

  // window_drawing.cpp
  std::pair<int, int> size() const;
  ViewRect view_rect() const;
  Camera seen() const;
  Camera without_extension() const;
  std::optional<Life> life() const;
  PictureSettings settings() const;
  void apply_look(PictureSettings& picture_settings) const;
  bool drawn() const;  // the displayed picture is of this scene
  bool moving() const;
  double screen_scale() const;
  float panel_scale() const;
  void fit_scale();
  void scale_panels(Command command);
  void interface_frame();
  std::array<std::uintptr_t, 4> show_ct_pictures();
  std::string hover_text() const;
  void request_picture();
  bool take_picture();
  bool lend_context();
  void draw(bool always, Image* copy = nullptr);
  Image read_back() const;
  const FrameState* frame() const { return render_request.frame.get(); }
};

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

constexpr double seen_through = 0.5;             // paler surfaces do not obstruct picking
constexpr double picture_interval_s = 1.0 / 60;  // minimum interval between pictures

}  // namespace condyle
