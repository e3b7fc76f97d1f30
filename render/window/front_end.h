#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "render/scene/shown_overlays.h"
#include "render/window/picture/map_surface.h"
#include "render/window/view/view_state.h"
#include "sim/frame/plot_set.h"

namespace condyle {

/// What a session asks of whoever shows it to a person: the window, or another front end. All calls
/// come from one thread, except wake_up().
class FrontEnd {
 public:
  virtual ~FrontEnd() = default;

  /// Handles the person's input, moves the playing clock and returns the requests.
  virtual const ViewState& poll() = 0;
  virtual const ViewState& view() const = 0;
  /// What was asked for once, since the last call.
  virtual std::vector<Request> take_requests() = 0;
  /// An edit that the person did not make by hand; with `remember` it can be undone.
  virtual void change(const std::function<void(ViewState&)>& edit, bool remember = false) = 0;

  /// Shows another case, from its first view. `keeper` keeps the parts for as long as they are
  /// needed.
  virtual void set_scene(const WindowScene& scene, const ViewState& start = {},
                         std::shared_ptr<const void> keeper = {}) = 0;
  /// The same patient made anew: its surfaces, in other memory. View and edits stay.
  virtual void renew_scene(const WindowScene& scene, std::shared_ptr<const void> keeper = {}) = 0;
  /// Another motion, other words or lists of the same case; its parts are the same.
  virtual void update_scene(const WindowScene& scene) = 0;
  /// Surfaces that frames may come with values for; kept as the parts are.
  virtual void set_map_surfaces(std::vector<MapSurface> surfaces,
                                std::shared_ptr<const void> keeper = {}) = 0;

  /// A new frame. `values`: one per vertex of each map surface; none: parts have their own colours.
  virtual void show(FrameState frame, const LoopStatistics& loop = {}, MapValues values = {}) = 0;
  /// There is no new frame.
  virtual void draw() = 0;
  /// Lines and sheets in space, of the newest frame, instead of those before.
  virtual void show_overlays(Overlays overlays) = 0;
  virtual void show_plots(std::vector<PlotSet> plots) = 0;

  /// What is being prepared, 0 to 1; empty when it is done.
  virtual void show_progress(const std::string& what, double fraction, bool can_cancel = false) = 0;
  /// The recording that is being made, 0 to 1; none when `what` is empty.
  virtual void show_recording(const std::string& what, double fraction) = 0;
  /// A sentence on a recording that can be resumed; empty: there is none.
  virtual void show_unfinished(const std::string& sentence) = 0;
  /// A sentence for some seconds.
  virtual void say(const std::string& sentence) = 0;
  /// What could not be done ("Cannot open the patient") and why, until the person closes it.
  virtual void report_error(const std::string& title, const std::string& sentence) = 0;
  /// Asks for the roles of surfaces that were dropped or opened.
  virtual void ask_roles(const request::Import& files) = 0;
  /// Asks a question whose answers are requests.
  virtual void ask(Question question) = 0;

  /// The person has closed the front end, but it stays: there is something to ask.
  virtual void keep_open() = 0;
  virtual void close() = 0;
  /// Ends the wait of poll(), e.g. when a frame is ready. From any thread.
  virtual void wake_up() = 0;
};

}  // namespace condyle
