#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "render/overlay/overlay_key.h"
#include "render/window/input/camera_control.h"
#include "render/window/input/shortcuts.h"
#include "render/window/panels/panel_form_state.h"
#include "render/window/panels/theme.h"
#include "render/window/settings/arrangement.h"
#include "render/window/settings/layout.h"
#include "render/window/view/edit_history.h"
#include "render/window/view/view_state.h"
#include "sim/frame/frame_state.h"
#include "sim/frame/plot_set.h"

namespace condyle {

/// The data that the panels show, read only.
struct PanelInput {
  const WindowScene& scene;
  const FrameState* frame = nullptr;  // none until the first is simulated
  std::span<const Eigen::Vector3f> displayed_face =
      {};  // its face's vertices, where displayed elsewhere
  LoopStatistics loop = {};
  PictureStatistics pictures = {};
  Camera camera = {};
  Eigen::AlignedBox3d box = {};             // of the scene at rest
  std::string progress = {};                // description of preparation; empty for none
  double progress_fraction = 0;             // 0 to 1
  bool can_cancel = false;                  // whether preparation can be cancelled
  std::span<const KeyEntry> key = {};       // to overlays
  std::span<const PlaceLabel> labels = {};  // of overlays
  std::string hover_text = {};              // text shown beside the mouse; empty for none
  std::span<const PlotSet> plots = {};
  bool kept = false;       // whether a state was kept for comparison; else the rest state is used
  bool recording = false;  // whether a recording is running
  std::string recording_what = {};
  double recording_fraction = 0;
  std::string unfinished = {};  // sentence on a recording that can be resumed
  std::filesystem::path recording_folder = ".";
  std::string recording_folder_name = {};  // "your videos folder"
  bool file_dialog = false;                // the desktop has one
  // Textures of the CT that is imported: three slices and the solid; 0: none.
  std::array<std::uintptr_t, 4> ct_pictures = {};
};

/// A panel, or a control in it, as last drawn. Names: panels "top", "left", "right",
/// "bottom", "cube", "legend", "key", "help", "error"; items "play", "scrub", "opening", "speed",
/// "show:mandible", ...
struct DrawnItem {
  std::string name;
  std::string panel;       // the panel that holds it; empty for a panel itself
  ViewRect rect;           // pixels from the top left
  std::string words = {};  // its text, of readings
};

/// The item under the mouse, for which a tooltip may appear.
struct TooltipWait {
  float x = -1, y = -1;  // corner of the item
  double since_s = 0;
  int last_pass = -2;     // over the panels, in which it was under the mouse
  bool put_away = false;  // clicked: the tooltip must not cover what the click reveals
  int passes = 0;         // number that have drawn a tooltip
  bool due = false;       // a tooltip is pending or visible
};

/// A failure and its reason.
struct Trouble {
  std::string title, sentence;
  bool operator==(const Trouble&) const = default;
};

/// The number of a plan's selected step that a handle changes; null: it places a point.
const PlanNumber* number_of(const PlanView& plan, const PlanHandle& handle);

/// The edit of the plan that the drawn cut requests; none before its second point.
std::optional<PlanEdit> drawn_cut_edit(const WindowScene& scene, const ViewState& view);

/// Panels of the window, drawn into the current ImGui frame (between NewFrame and Render). They
/// depend on neither GLFW nor GL, so tests draw them with scripted input.
class Panels {
 public:
  /// Loads the theme into the current ImGui context.
  explicit Panels(float scale, bool light = false);

  /// Draws all panels over a display of this size; applies the user's input to `view`.
  /// Returns the commands that the window must carry out (views, pictures, quit).
  std::vector<Command> draw(const PanelInput& input, ViewState& view, double width, double height);

  /// Carries out commands on playback, panels and dialogs. Returns false for the window's commands.
  bool run(Command command, const WindowScene& scene, ViewState& view);

  /// Whether a key may trigger it now: while a dialog is open, keys only close it, save pictures
  /// and quit.
  bool takes(Command command) const;

  /// An edit begins: undo restores the present state.
  void remember(const ViewState& view) { history_.remember(view.edits()); }
  /// Discards the edit history, whose states are of other parts.
  void forget_edits();
  /// Called for another patient: discards the edit history and the content of fields.
  void forget_patient();

  /// Shows a failure in a dialog until that is closed; several are queued.
  void report_error(const Trouble& trouble);
  /// The text on show; empty without one.
  Trouble trouble() const { return errors_.empty() ? Trouble{} : errors_.front(); }
  /// Called for a key that the open dialog does not accept: the dialog then shows how to close it.
  void refuse_key() { key_refused_ = true; }
  /// Shows a sentence at the foot of the window for a few seconds.
  void say(const std::string& sentence);
  const std::string& said() const { return said_; }

  /// Loads fonts and sizes for another scale; the renderer's font texture must be rebuilt.
  void set_scale(float scale);
  void set_light(bool light);
  const Theme& theme() const { return theme_; }

  /// Asks for the roles of surfaces.
  void ask_roles(request::Import import) { form_.import = std::move(import); }
  /// Opens the menu of a part.
  void open_part_menu(const PartMenu& menu) { form_.part_menu = menu; }
  /// Asks in a box; the answer is a request.
  void ask(Question question) { form_.question = std::move(question); }
  const Question* question() const { return form_.question ? &*form_.question : nullptr; }
  /// Adds a request; of successive previews the last one counts.
  void request(Request request);
  /// Whether the handles of the plan's selected step are shown.
  bool shows_handles(const ViewState& view) const {
    return shown_ && view.tab == SideTab::plan &&
           (view.tool == Tool::look || view.tool == Tool::cut);
  }
  void set_record_folder(const std::filesystem::path& folder) {
    form_.record.folder = folder.string();
  }
  /// One-time requests since the last call.
  std::vector<Request> take_requests() { return std::exchange(requests_, {}); }

  bool dialog_open() const {
    return help_open_ || !errors_.empty() || form_.question || form_.files.open || form_.import ||
           form_.session.open;
  }
  /// Whether something will appear or disappear with time: a sentence, a tooltip.
  bool talking() const { return !said_.empty() || tooltip_.due; }
  bool shown() const { return shown_; }
  Layout layout(double width, double height, const ViewState& view = {}) const {
    return lay_out(width, height, theme_.scale, shown_,
                   {.plots = view.plots, .tool = view.tool != Tool::look}, sizes_);
  }
  /// Sizes set by dragging splitters, and unfolded groups of the tree.
  const PanelSizes& sizes() const { return sizes_; }
  const std::vector<std::string>& open_groups() const { return open_groups_; }
  const RecordChoice& record_choice() const { return record_; }
  void arrange(const PanelSizes& sizes, std::vector<std::string> open_groups,
               RecordChoice record = {}) {
    record_ = std::move(record);
    sizes_ = sizes;
    open_groups_ = std::move(open_groups);
  }
  const std::vector<DrawnItem>& items() const { return items_; }

 private:
  struct Drawing;  // one pass over all panels: panels_*.cpp
  PlotSet stage_plots() const;
  void answer(std::size_t which);
  // Parts of run(); each returns false for the commands of the others.
  bool run_playing(Command command, const WindowScene& scene, ViewState& view);
  bool run_showing(Command command, const WindowScene& scene, ViewState& view);
  bool run_tool(Command command, const WindowScene& scene, ViewState& view);
  bool run_dialog(Command command);
  bool run_session(Command command, const WindowScene& scene);  // panel_session.cpp
  Theme theme_;
  bool shown_ = true, help_open_ = false;
  bool ct_open_ = false;  // a CT is imported, in the place of the patient
  PanelSizes sizes_;
  double gripped_size_ = 0;  // size at the grip of the panel being resized
  double skin_before_ = 1;   // opacity to restore
  std::vector<std::string> open_groups_ = default_groups();  // of the tree
  std::string to_sight_;  // a group that was just unfolded, to scroll to
  std::deque<Trouble> errors_;
  bool key_refused_ = false;  // since the dialog was opened
  std::string said_;
  TooltipWait tooltip_;
  double said_until_ = 0;
  EditHistory<Edits> history_;
  bool undo(ViewState& view, bool back);
  void accept_cut(const WindowScene& scene, const ViewState& view);
  void remember_edits(const Edits& before, const ViewState& view);
  bool undone_ = false;     // in this pass
  bool fold_list_ = false;  // fold the open list in the next pass
  bool editing_ = false;    // the control being dragged has changed the view
  PanelFormState form_;
  RecordChoice record_;
  std::vector<Request> requests_;
  // Times of the last steps, for the curves; of bounded length.
  std::vector<float> step_ms_;
  std::vector<std::array<double, stage_names.size()>> stage_ms_;
  std::uint64_t last_step_ = 0;
  Pose X_CM_;  // of the frame as last drawn
  std::vector<DrawnItem> items_;
};

}  // namespace condyle
