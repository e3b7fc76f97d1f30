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

/// Interface of a session to what shows it to the user: the window, or another front end. All calls
/// come from one thread, except wake_up().
class FrontEnd {
 public:
  virtual ~FrontEnd() = default;

  /// Handles the user's input, moves the playing clock and returns the requests.
  virtual const ViewState& poll() = 0;
  virtual const ViewState& view() const = 0;
  /// One-time requests since the last call.
  virtual std::vector<Request> take_requests() = 0;
  /// Applies an edit that the user did not make by hand; with `remember` it can be undone.
  virtual void change(const std::function<void(ViewState&)>& edit, bool remember = false) = 0;

  /// Shows another case, from its first view. `keeper` keeps the parts for as long as they are
  /// needed.
  virtual void set_scene(const WindowScene& scene, const ViewState& start = {},
                         std::shared_ptr<const void> keeper = {}) = 0;
  /// Shows the same patient after an edit of its plan. The camera stays, and unless parts or their
  /// planned positions are `new_parts`, the history of edits.
  virtual void replace_scene(const WindowScene& scene, const ViewState& start,
                             std::shared_ptr<const void> keeper, bool new_parts) = 0;
  /// Shows the same patient rebuilt, with its surfaces in other memory. View and edits stay.
  virtual void renew_scene(const WindowScene& scene, std::shared_ptr<const void> keeper = {}) = 0;
  /// Shows another motion, other texts or lists of the same case; its parts are the same.
  virtual void update_scene(const WindowScene& scene) = 0;
  /// Sets the surfaces for which frames may have values; they are kept alive like the parts.
  virtual void set_map_surfaces(std::vector<MapSurface> surfaces,
                                std::shared_ptr<const void> keeper = {}) = 0;

  /// Shows a new frame. `values`: one per vertex of each map surface; none: the parts' own colours.
  virtual void show(FrameState frame, const LoopStatistics& loop = {}, MapValues values = {}) = 0;
  /// Called when there is no new frame.
  virtual void draw() = 0;
  /// Replaces the lines and sheets in space by those of the newest frame.
  virtual void show_overlays(Overlays overlays) = 0;
  virtual void show_plots(std::vector<PlotSet> plots) = 0;

  /// Progress of preparation, 0 to 1; an empty text when it is done.
  virtual void show_progress(const std::string& what, double fraction, bool can_cancel = false) = 0;
  /// Progress of the recording, 0 to 1; none if `what` is empty.
  virtual void show_recording(const std::string& what, double fraction) = 0;
  /// Sets the sentence on a recording that can be resumed; empty: there is none.
  virtual void show_unfinished(const std::string& sentence) = 0;
  /// Shows a sentence for some seconds.
  virtual void say(const std::string& sentence) = 0;
  /// Reports a failure ("Cannot open the patient") and its reason, until the user closes it.
  virtual void report_error(const std::string& title, const std::string& sentence) = 0;
  /// Asks for the roles of dropped or opened surfaces.
  virtual void ask_roles(const request::Import& files) = 0;
  /// Asks a question whose answers are requests.
  virtual void ask(Question question) = 0;

  /// The camera in the world's frame.
  virtual const Camera& camera() const = 0;
  virtual void set_camera(const Camera& camera) = 0;
  /// Puts a folder that the user has chosen into the field for recordings.
  virtual void set_record_folder(const std::filesystem::path& folder) = 0;

  /// Keeps the front end open after the user has closed it, to ask a question.
  virtual void keep_open() = 0;
  virtual void close() = 0;
  /// Ends the wait of poll(), e.g. when a frame is ready. Thread-safe.
  virtual void wake_up() = 0;
};

}  // namespace condyle
