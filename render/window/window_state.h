#pragma once

#include <GLFW/glfw3.h>
#include <epoxy/gl.h>

#include <Eigen/Geometry>
#include <chrono>
#include <deque>
#include <exception>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "render/window/glfw_session.h"
#include "render/window/handles.h"
#include "render/window/mouse_queue.h"
#include "render/window/picture_texture.h"
#include "render/window/picture_thread.h"
#include "render/window/pointing.h"
#include "render/window/quality.h"
#include "render/window/seen_face.h"
#include "render/window/window.h"

struct ImGuiContext;

namespace condyle {

/// What a Window holds. Only for window*.cpp.
struct Window::State {
  using Clock = std::chrono::steady_clock;

  explicit State(const WindowOptions& options);
  ~State();

  // In the order of their making; undone backwards.
  GlfwSession session;
  GLFWwindow* window = nullptr;
  ImGuiContext* imgui = nullptr;
  std::optional<Panels> panels;
  std::optional<PictureTexture> texture;
  GLFWwindow* spare = nullptr;  // never seen: lends its context to the painter where EGL has none
  std::optional<PictureThread> painter;

  WindowOptions options;
  Arrangement arrangement;  // theme, scale and size: the rest is where it is used
  WindowScene scene;
  SeenFace seen_face{scene.parts};
  ViewState view;
  Eigen::AlignedBox3d box;  // of the scene at rest
  PictureOrder order;       // the newest picture that is wanted
  // To compare with: the first frame, or the one that was kept.
  std::shared_ptr<const FrameState> kept;
  bool kept_by_hand = false;
  std::shared_ptr<const MapValues> kept_values;  // its distances; none: they were not shown
  Look ordered_look;
  bool looked = false;       // at mouse and keyboard, at least once
  bool cannot_draw = false;  // the last picture failed
  LoopStatistics loop;
  Camera camera;  // in the room, in which a hand may have moved the skull
  ZoomLimits zoom;
  std::string progress, recording, unfinished;
  double progress_fraction = 0, recording_fraction = 0;
  bool can_cancel = false;
  std::vector<PlotSet> plots;
  Overlays overlays;
  bool overlays_due = true;                    // not ordered yet
  std::vector<std::filesystem::path> dropped;  // on the window, not taken yet

  MouseQueue mouse;
  MouseMoment mouse_shown;  // to the panels
  /// Keys and letters for a field that is written in, in their order, each with its own pass over
  /// the panels.
  struct KeyMoment {
    int key = 0;
    bool down = false;
    int mods = 0;
    unsigned letter = 0;  // that was typed; 0: a key
  };
  std::deque<KeyMoment> keys;
  CameraDrag drag = CameraDrag::none;
  int drag_button = -1;
  /// A body in the hand, from the moment it was gripped.
  struct Held {
    Grip grip;
    std::size_t body;
    HandleView view;
    Pose start;  // in the cranium's frame; of the skull in the room
    Eigen::Vector2d from;
  };
  std::optional<Held> held;

  QualityGovernor governor;
  PictureStatistics pictures;
  bool scene_changed = true;  // what was ordered last is out of date
  bool save_window = false;
  int frames_due = 3;        // pictures of the panels still to draw
  int counted_pictures = 0;  // since counted_from
  Clock::time_point last_order{};
  Clock::time_point last_poll = Clock::now(), last_look = last_poll, last_draw = last_poll,
                    last_change = last_poll, last_event = last_poll, counted_from = last_poll;

  // window_input.cpp
  void install_callbacks();
  void install_key_callbacks();
  void on_key(int key, int scancode, int mods);
  void on_button(int button, bool down, int mods);
  void on_move(double x, double y);
  void on_wheel(double clicks);
  bool over_view(double x, double y) const;
  bool set_point(const Eigen::Vector2d& at);
  bool grip_body(const Eigen::Vector2d& at);
  void move_body(const Eigen::Vector2d& at);
  std::optional<PointedPlace> surface_under(const Eigen::Vector2d& at, bool with_face) const;
  void run(Command command);
  void note_size();
  void set_standard_view(std::string_view name);
  void wait_for_events();
  bool input_waits() const { return mouse.waiting() || !keys.empty(); }
  /// GLFW is C: nothing may be thrown through it.
  template <class Work>
  static void guarded(GLFWwindow* w, Work&& work) {
    State& state = *static_cast<State*>(glfwGetWindowUserPointer(w));
    state.noticed();
    try {
      work(state);
    } catch (const std::exception& error) {
      state.panels->report_error(error.what());
    }
  }
  /// Something happened: ImGui needs some pictures to settle what is hovered and held.
  void noticed() {
    frames_due = 3;
    last_event = Clock::now();
  }

  // window_drawing.cpp
  std::pair<int, int> size() const;
  ViewRect view_rect() const;
  Camera seen() const;
  PictureSettings settings() const;
  void apply_look(PictureSettings& wanted) const;
  bool drawn() const;  // the picture on show is of this scene
  bool moving() const;
  double screen_scale() const;
  float panel_scale() const;
  void fit_scale();
  void scale_panels(Command command);
  void interface_frame();
  std::string pointed() const;
  void order_picture();
  bool take_picture();
  bool lend_context();
  void draw(bool always, Image* copy = nullptr);
  Image read_back() const;
  const FrameState* frame() const { return order.frame.get(); }
};

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

constexpr double picture_interval_s = 1.0 / 60;  // no more pictures than this

}  // namespace condyle
