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
#include "render/window/input/input_event.h"
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
  // Scale of panels and text, times the screen's own scale; Ctrl+0 restores it. None: 1, more on
  // screens with small pixels.
  std::optional<double> default_scale = {};
  std::filesystem::path picture_folder = ".";    // for F12
  std::filesystem::path recording_folder = ".";  // in which recordings get folders of their own
  std::string recording_folder_name = {};        // "your videos folder"
  bool file_dialog = false;                      // the desktop has one
};

/// The window on a case. It states its requests in a ViewState and shows the frames it is given.
/// The picture is drawn on its own thread; the simulation should run on another one:
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
  /// throws: MachineError when there is no display or no OpenGL 3.3, stating a remedy.
  explicit Window(const WindowOptions& options = {});
  ~Window() override;
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Shows another case, from its first view. `start` may hold other settings than the defaults.
  /// The parts are uploaded in the background; `keeper` keeps them for as long as they are needed
  /// (without one they must outlive the window).
  void set_scene(const WindowScene& scene, const ViewState& start = {},
                 std::shared_ptr<const void> keeper = {}) override;

  /// False once the user has closed the window.
  bool open() const;
  void close() override;
  /// Keeps the window open after the user has closed it, to ask a question.
  void keep_open() override;

  /// Handles events, moves the playing clock and returns the requests. Waits for the next
  /// picture's time while something moves (at most 1/60 s) and up to 1/4 s when nothing does.
  const ViewState& poll() override;

  /// Sets the surfaces for which frames may have values, in this order; kept alive like the parts.
  void set_map_surfaces(std::vector<MapSurface> surfaces,
                        std::shared_ptr<const void> keeper = {}) override;

  /// Takes a frame and draws if anything has changed. Repeating the same frame costs nothing.
  /// `values`: one per vertex of each map surface, drawn in the scene's colours for distances;
  /// none: the parts' own colours.
  void show(FrameState frame, const LoopStatistics& loop = {}, MapValues values = {}) override;
  /// Draws if anything has changed, without a new frame.
  void draw() override;

  /// Shows the same patient rebuilt, with its surfaces in other memory. View and edits stay.
  void replace_scene(const WindowScene& scene, const ViewState& start,
                     std::shared_ptr<const void> keeper, bool new_parts) override;
  void renew_scene(const WindowScene& scene, std::shared_ptr<const void> keeper = {}) override;
  /// Shows another motion, other texts or lists of the same case; its parts are the same.
  void update_scene(const WindowScene& scene) override;
  /// Applies an edit that the user did not make by hand; with `remember` it can be undone.
  void change(const std::function<void(ViewState&)>& edit, bool remember = false) override;
  /// One-time requests since the last call.
  std::vector<Request> take_requests() override;
  /// Asks for the roles of dropped or opened surfaces.
  void ask_roles(const request::Import& files) override;
  /// Asks in a box; the answer is a request.
  void ask(Question question) override;
  /// The question that has not been answered yet.
  const Question* question() const;
  void show_plots(std::vector<PlotSet> plots) override;
  /// Replaces the lines and sheets in space by those of the newest frame.
  void show_overlays(Overlays overlays) override;

  /// Progress of background work, 0 to 1; an empty text when it is done.
  void show_progress(const std::string& what, double fraction, bool can_cancel = false) override;
  /// Progress of the recording, 0 to 1; none if `what` is empty.
  void show_recording(const std::string& what, double fraction) override;
  /// Sets the sentence on a recording that can be resumed; empty: there is none.
  void show_unfinished(const std::string& sentence) override;
  /// Shows a sentence at the foot of the window for some seconds.
  void say(const std::string& sentence) override;
  /// Shows a sentence in a dialog.
  void report_error(const std::string& title, const std::string& sentence) override;
  /// Ends the wait of poll(), e.g. when a frame is ready. Thread-safe during the window's lifetime.
  static void wake();
  void wake_up() override { wake(); }

  const ViewState& view() const override;
  const WindowScene& scene() const;
  /// The sentence of the open dialog; empty without one.
  std::string trouble() const;
  /// The present text at the foot; empty for none.
  const std::string& said() const;
  const Camera& camera() const override;
  void set_camera(const Camera& camera) override;
  void set_record_folder(const std::filesystem::path& folder) override;
  const PictureStatistics& pictures() const;
  /// Panels and their controls, as last drawn, in screen coordinates of the window.
  const std::vector<DrawnItem>& items() const;
  /// Rectangle of the 3-D view.
  ViewRect view_rect() const;
  /// The arrangement that the user has chosen.
  Arrangement arrangement() const;
  /// From now on the user's mouse and keyboard are ignored, except Esc, which ends the replay;
  /// handle() receives the input instead. A pointer is drawn.
  void begin_replay();
  void end_replay();
  /// False before the replay and after its end, also by Esc.
  bool replaying() const;
  void handle(const InputEvent& event);
  /// Draws now, including the finished 3-D picture, and returns the whole window.
  Image picture();

 private:
  void change_parts(const WindowScene& scene, const ViewState& start,
                    std::shared_ptr<const void> keeper);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
