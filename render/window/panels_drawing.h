#pragma once

#include <string>
#include <vector>

#include "render/window/panels.h"
#include "render/window/widgets.h"
#include "sim/frame/part_names.h"

namespace condyle {

/// One pass over all panels. Only for this room: each function stands in its own file.
struct Panels::Drawing {
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
  void moving();      // panel_move.cpp: handles, and the chosen body's place in numbers
  void measuring();   // panel_measure.cpp: points and lines until they are cleared; its tool
  void landmarks();   // panel_landmarks.cpp
  void plots();       // panel_plots.cpp
  void edges();       // panel_edges.cpp: between panels, to draw them wider or higher
  void view_signs();  // panel_view.cpp: letters at the edges, cube, progress
  void dialogs();     // panel_dialogs.cpp
  void question_dialog();

 private:
  void motion();  // panel_motion.cpp
  void record();  // panel_record.cpp
  float record_label(const char* words);
  void record_cameras();
  void open_dialog();    // panel_files.cpp
  void import_dialog();  // panel_files.cpp
  void side_tabs();
  void part_list();
  void tree();  // panel_tree.cpp
  int tree_rows() const;
  bool unfolded(const std::string& group) const;
  void look();  // panel_look.cpp
  void scale();
  void readings();
  void opening();
  void contacts(float list_height);
  void tissue();
  void times();
  void progress();
  std::optional<double> edge(const char* name, const ViewRect& place, double size, double way,
                             double usual);
  void cube();
  // panel_legend.cpp; each gives its pane, empty without one:
  ViewRect legend();  // of a map, in the lower left corner of the view
  ViewRect key();     // to overlays, in its upper right corner
  void pointed();     // what the mouse is on
  void beside_mouse(const std::string& words);
};

/// Stands in the window at all times.
constexpr const char* purpose = "For research and education, not for clinical use";

/// Centred, above everything, with the rest dimmed; pair with EndPopup when it gives true.
bool begin_dialog(Pen& pen, const char* name, float dialog_width, double width, double height);

/// The motion of a scene for people: "Chewing right"; words and files as they are.
std::string motion_title(const WindowScene& scene);

}  // namespace condyle
