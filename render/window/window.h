#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "render/camera/camera.h"
#include "render/image/image.h"
#include "render/window/front_end.h"
#include "render/window/panels/panels.h"
#include "render/window/picture/render_request.h"
#include "render/window/settings/arrangement.h"
#include "render/window/view/view_state.h"
#include "sim/frame/frame_state.h"

namespace condyle {

struct WindowOptions {
  std::string title = "Condyle";
  Arrangement arrangement = {};
  bool fit_screen = false;  // make the window no larger than the screen, which may be another one
  // Of panels and text, times the screen's own scale, which Ctrl+0 comes back to; none: 1, more on
  // screens with small pixels.
  std::optional<double> default_scale = {};
  std::filesystem::path picture_folder = ".";  // where F12 and recordings go
};

/// The window on a case. It asks by a ViewState and shows what it is given; the picture is drawn on
/// a thread of its own, and the simulation runs elsewhere, best in another thread, too:
///
///     Window window({.title = "Condyle"});
///     window.set_scene({.parts = parts, .case_name = "Built-in patient", .duration_s = 4});
///     while (window.open()) {
///       simulation.want(window.poll());
///       if (simulation.has_news()) window.show(simulation.newest(), {.steps_per_second = 60});
///       else window.draw();
///     }
///
/// One window at a time, on the main thread; only wake() may be called from others.
class Window : public FrontEnd {
 public:
  /// throws: MachineError when there is no display or no OpenGL 3.3, saying what to do instead.
  explicit Window(const WindowOptions& options = {});
  ~Window() override;
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Shows another case, from its first view. `start` may hold other settings than the defaults.
  /// The parts are uploaded beside the window; `keeper` keeps them for as long as they are needed
  /// (without one they must outlive the window).
  void set_scene(const WindowScene& scene, const ViewState& start = {},
                 std::shared_ptr<const void> keeper = {}) override;

  /// False once the person has closed the window.
  bool open() const;
  void close() override;
  /// The person has closed it, but it stays: there is something to ask.
  void keep_open() override;

  /// Handles events, moves the playing clock and returns the requests. Waits for the next
  /// picture's time while something moves (at most 1/60 s) and up to 1/4 s when nothing does.
  const ViewState& poll() override;

  /// Surfaces that frames may come with values for, in the order of these; kept as the parts are.
  void set_map_surfaces(std::vector<MapSurface> surfaces,
                        std::shared_ptr<const void> keeper = {}) override;

  /// Takes over a frame and draws if anything has changed. The same frame again costs nothing.
  /// `values`: one per vertex of each map surface, drawn in the scene's colours for distances;
  /// none: parts look like themselves.
  void show(FrameState frame, const LoopStatistics& loop = {}, MapValues values = {}) override;
  /// Draws if anything has changed: when there is no new frame.
  void draw() override;

  /// The same patient made anew: its surfaces, in other memory. View and edits stay.
  void renew_scene(const WindowScene& scene, std::shared_ptr<const void> keeper = {}) override;
  /// Another motion, other words or lists of the same case; its parts are the same.
  void update_scene(const WindowScene& scene) override;
  /// An edit that the person did not make by hand; with `remember` it can be undone.
  void change(const std::function<void(ViewState&)>& edit, bool remember = false) override;
  /// What was asked for once, since the last call.
  std::vector<Request> take_requests() override;
  /// Asks for the roles of surfaces that were dropped or opened.
  void ask_roles(const request::Import& files) override;
  /// Asks in a box; the answer is a request.
  void ask(Question question) override;
  /// The question that has not been answered yet.
  const Question* question() const;
  void show_plots(std::vector<PlotSet> plots) override;
  /// Lines and sheets in space, of the newest frame, instead of those before.
  void show_overlays(Overlays overlays) override;

  /// Progress of background work, 0 to 1; an empty text when it is done.
  void show_progress(const std::string& what, double fraction, bool can_cancel = false) override;
  /// The recording that is being made, 0 to 1; none when `what` is empty.
  void show_recording(const std::string& what, double fraction) override;
  /// Of a recording that can go on, as a sentence; empty: there is none.
  void show_unfinished(const std::string& sentence) override;
  /// Says a sentence at the foot of the window for some seconds.
  void say(const std::string& sentence) override;
  /// Shows a sentence in a dialog.
  void report_error(const std::string& title, const std::string& sentence) override;
  /// Ends the wait of poll(), e.g. when a frame is ready. From any thread, while the window lives.
  static void wake();
  void wake_up() override { wake(); }

  const ViewState& view() const override;
  const WindowScene& scene() const;
  /// The sentence of the dialog that is open; empty without one.
  std::string trouble() const;
  /// What is said at the foot now; empty for nothing.
  const std::string& said() const;
  const Camera& camera() const;
  void set_camera(const Camera& camera);
  const PictureStatistics& pictures() const;
  /// Panels and what can be used in them, as last drawn, screen coordinates of the window.
  const std::vector<DrawnItem>& items() const;
  /// Where the 3-D view is.
  ViewRect view_rect() const;
  /// The arrangement that the user has chosen.
  Arrangement arrangement() const;
  /// Draws now, the finished 3-D picture with it, and gives the whole window.
  Image picture();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
