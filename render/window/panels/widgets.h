#pragma once

#include <imgui.h>

#include <optional>
#include <string>
#include <vector>

#include "render/window/panels/panels.h"

namespace condyle {

/// Context of every widget: sizes, fonts, and the list of drawn items. Only for this module.
struct Pen {
  const Theme& theme;
  std::vector<DrawnItem>& items;
  TooltipWait& resting;
  std::string panel;  // the panel being drawn

  float px(float units) const { return units * theme.scale; }
  ImVec2 px(float x, float y) const { return {x * theme.scale, y * theme.scale}; }
  /// Records the last ImGui item if any of it is visible.
  void mark(const std::string& name, const std::string& words = {});
};

constexpr float button_gap = 5;  // between the buttons of a row, at scale 1
/// Width of each of `count` buttons that share a row of this width, pixels.
float width_of_each(const Pen& pen, float width, int count);

/// A fixed panel: no title, no moving. Always pair with end_panel.
void begin_panel(Pen& pen, const char* name, const ViewRect& rect);
void end_panel();

/// A heading in small letters, with a line above unless it is the first of its panel; `right` is
/// drawn in a dim colour at the other end.
void heading(Pen& pen, const char* text, const std::string& right = {});

/// Text with its own font and colour; text_right ends at the right edge of the content.
void text(ImFont* font, ImU32 colour, const std::string& words);
void text_right(ImFont* font, ImU32 colour, const std::string& words);
/// The text, shortened with an ellipsis to fit the width in this font.
std::string fitted(ImFont* font, const std::string& words, float width);
float text_width(ImFont* font, const std::string& words);

/// A small triangle that opens and closes a group. Returns true when clicked.
bool fold(Pen& pen, const std::string& name, bool open);

/// Tooltip of the last item, once the mouse has rested on it for a moment; none after a click on it
/// until the mouse has left it, and none over an open list.
void tooltip(Pen& pen, const char* words);

/// Buttons with a drawn symbol.
enum class Sign {
  play,
  pause,
  step_back,
  step_forward,
  to_start,
  loop,
  camera,
  help,
  reset,
  close
};
bool sign_button(Pen& pen, const char* name, Sign sign, ImVec2 size, ImU32 background);
/// A button with a word or a letter; `on` fills it with the accent.
bool word_button(Pen& pen, const char* name, const char* label, ImVec2 size, bool on);

struct SliderLook {
  double low = 0, high = 1;
  float width = 100;  // pixels
  bool logarithmic = false;
  bool filled = true;  // bar filled up to the handle
  bool held = false;   // handle in the warning colour: the hand overrides the motion
  double typed = 1;    // typed number for a value of 1: 100 for a fraction shown in %
};
/// A field for a number in a printf format, of the width set for the next item. Typed text stays in
/// `draft` until Enter, Tab or a click elsewhere enters it. Returns true when another number was
/// entered.
bool number_field(Pen& pen, const char* name, double& value, const char* format,
                  std::optional<NumberEntry>& draft);

/// A flat slider: a thin bar with a round handle over `width`. Returns true while it changes.
/// Ctrl+click opens a field for the number; Enter takes it, limited to the slider's range.
bool slider(Pen& pen, const char* name, double& value, const SliderLook& look);

/// A text field, with a hint while it is empty. Returns true when Enter is pressed.
bool text_field(Pen& pen, const char* name, std::string& words, float width, const char* hint);

/// Whether a drop-down list is open, in front of any dialog; and closes it.
bool list_unfolded();
void fold_list();

/// A selectable row of a list, filled while selected. Returns true at the press of the mouse, when
/// Ctrl and Shift have the intended state.
bool select_row(const std::string& label, bool chosen);

/// A checkbox with its label.
bool tick_box(Pen& pen, const char* name, const char* label, bool& on);

}  // namespace condyle
