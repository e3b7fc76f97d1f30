#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/window/settings/layout.h"
#include "render/window/view/record_choice.h"
#include "render/window/view/view_state.h"

namespace condyle {

/// Groups of the tree that are initially unfolded.
inline std::vector<std::string> default_groups() { return {"bones", "free", "teeth"}; }

/// The user's arrangement of the window, without data of the patient; stored between runs. Hidden
/// panels (Tab) are not part of it: a window that opens without any would look broken.
struct Arrangement {
  bool light = false;                   // theme of the panels
  std::optional<double> ui_scale = {};  // times the screen's own; none: the default
  int width = 1280, height = 720;       // before the screen's own scale
  bool maximized = false;               // then the size is the one to restore
  PanelSizes sizes = {};
  PanelChoice panels = {};
  std::vector<std::string> open_groups = default_groups();  // of the tree
  RecordChoice record = {};
  bool operator==(const Arrangement&) const = default;
};

}  // namespace condyle
