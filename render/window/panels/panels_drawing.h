#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "render/window/panels/panels.h"
#include "render/window/panels/widgets.h"
#include "render/window/view/measuring.h"
#include "sim/frame/part_names.h"

namespace condyle {

/// One pass over all panels. Only for this module: each function is defined in the file named.
struct Panels::Drawing {
  /// Distance of a body from its target; 0 where no hand holds it.
  struct Shortfall {
    double shift_mm = 0, turn_deg = 0;
  };
  /// Result of the dialog Open.
  struct OpenChoice {
    std::vector<std::filesystem::path> files;
    bool builtin = false, close = false;
  };

  Panels& panels;
  const PanelInput& input;
  ViewState& view;
  Layout layout;
  double display_width, display_height;  // pixels
  Pen pen;
  std::vector<Command> commands;

  void top_bar();     // panels.cpp
  void timeline();    // panel_timeline.cpp
  void parts();       // panel_parts.cpp
  void side();        // panel_readings.cpp
  void moving();      // panel_move.cpp: handles, and the selected body's pose in numbers
  void measuring();   // panel_measure.cpp: points and lines, and the tool
  void landmarks();   // panel_landmarks.cpp
  void plots();       // panel_plots.cpp
  void edges();       // splitters.cpp: between panels, to resize them
  void view_signs();  // panel_view.cpp: letters at the edges, cube, progress
  void cutting();     // panel_cut.cpp: the drawn cut, and handles of the plan
  void part_menu();   // panel_part_menu.cpp
  void ct();          // panel_ct.cpp: the import of a CT, in the place of all others
  void dialogs();     // panel_dialogs.cpp
  void question_dialog();
  void session_dialog();  // panel_session.cpp
  void key_hint(const char* words);

 private:
  // panel_cut.cpp
  void preview_drawn_cut();
  void drawn_cut_line();
  void plan_handles();
  void cut_panel();
  void cut_numbers(DrawnCut& drawn);
  void cut_findings();
  void cut_buttons(DrawnCut& drawn);
  // panel_part_menu.cpp
  bool menu_row(const char* name, const char* label, bool enabled = true);
  bool part_menu_looks(std::size_t which);
  bool part_menu_tools(const PartMenu& menu);
  // panel_move.cpp
  void gizmo(const MovableBody& body);
  void body_choice(const MovableBody& body);
  void body_placement(const MovableBody& body);
  void body_state(const MovableBody& body, bool held, const Shortfall& shortfall);
  void body_buttons(const MovableBody& body);
  // panel_measure.cpp
  void measured_line(const Measured& result);
  void measure_label(std::span<const ImVec2> line, const std::string& words);
  void measure_panel(const Measured& result, std::span<const Eigen::Vector3d> places);
  void measure_buttons(const Measured& result, std::span<const Eigen::Vector3d> places);
  // panel_landmarks.cpp
  void landmark_marks();
  void landmark_list();
  void landmark_edits();
  void landmark_uses();
  // panel_motion.cpp
  void motion();
  void motion_choice();
  void motion_muscles();
  void motion_parameters();
  // panel_face.cpp
  void face();
  void expression_row(const TreeItem& item);
  // panel_plan.cpp
  void plan();
  void plan_steps();
  void plan_step(const PlanStepView& step);
  void plan_numbers(const PlanStepView& step);
  void plan_graft_additions();
  void plan_splints();
  void plan_additions();
  void plan_results();
  void plan_buttons();
  bool plan_table(const char* name, const char* title, const std::vector<PlanMeasure>& rows);
  void edit_plan(PlanEdit edit);
  // panel_ct.cpp
  void ct_series(float high);
  void ct_controls();
  void ct_threshold();
  void ct_seeds();
  void ct_making();
  void ct_progress();
  // panel_ct_slices.cpp
  void ct_pictures(const ViewRect& place);
  void ct_slice(std::size_t which, const ViewRect& place);
  void ct_solid(const ViewRect& place);
  // panel_record.cpp
  void record();
  float record_label(const char* words);
  void record_picture();
  void record_size();
  void record_quality();
  void record_cameras();
  void record_contents();
  void record_folder();
  void record_progress();
  void record_button();
  void record_note();
  // panel_files.cpp
  void open_dialog();
  void recent_list(float column, OpenChoice& chosen);
  void folder_list(float column, OpenChoice& chosen);
  void open_path(OpenChoice& chosen);
  void import_dialog();
  void side_tabs();
  void part_list();
  float notes_room(float left) const;
  void tree();  // panel_tree.cpp
  int tree_rows() const;
  bool unfolded(const std::string& group) const;
  void fold_group(const std::string& group);  // or unfolds it
  // panel_look.cpp
  void look();
  void look_cuts();
  void look_comparison();
  void look_overlays();
  void look_distances();
  void look_displacement();
  void look_muscles(bool has_tissue);
  void look_springs();
  void look_panel_size();
  void scale();     // panel_view.cpp
  void readings();  // panel_readings.cpp, as what follows
  void opening();
  void opening_slider(double live);
  void opening_measures();
  void contacts(float list_height);
  void tissue();
  void performance();  // times of a step and of pictures; details are folded
  void stage_bars(const StageTimes& times, double full_ms);
  void step_curve();
  void progress();
  std::optional<double> edge(const char* name, const ViewRect& place, double size, double direction,
                             double reset);
  void cube();
  // panel_legend.cpp; each returns its pane, empty without one:
  ViewRect legend();  // of a map, in the lower left corner of the view
  void overlay_labels();
  ViewRect key();     // to overlays, in its upper right corner
  void hover_text();  // of the hovered surface
  void beside_mouse(const std::string& words);
};

/// Always visible in the window.
constexpr const char* purpose = "For research and education, not for clinical use";

/// Centred, above everything, with the rest dimmed; pair with EndPopup if it returns true.
bool begin_dialog(Pen& pen, const char* name, float dialog_width, double width, double height);

/// Readable name of a scene's motion: "Chewing right"; scripts and files unchanged.
std::string motion_title(const WindowScene& scene);

}  // namespace condyle
