#pragma once

#include <imgui.h>

#include <optional>
#include <string>
#include <vector>

#include "render/window/panels/panels.h"

namespace condyle {

/// What every widget needs: sizes, fonts, and the list of what was drawn. Only for this module.
struct Pen {
  const Theme& theme;
  std::vector<DrawnItem>& items;
  TooltipWait& resting;
  std::string panel;  // the one being drawn

  float px(float units) const { return units * theme.scale; }
  ImVec2 px(float x, float y) const { return {x * theme.scale, y * theme.scale}; }
  /// Notes the last ImGui item, when any of it can be seen.
  void mark(const std::string& name, const std::string& words = {});
};

constexpr float button_gap = 5;  // between the buttons of a row, at scale 1
/// Width of each of `count` buttons in a row of this width, pixels.
float width_of_each(const Pen& pen, float width, int count);

/// A fixed panel: no title, no moving. Always pair with end_panel.
void begin_panel(Pen& pen, const char* name, const ViewRect& rect);
void end_panel();

/// A heading in small letters, with a line above unless it is the first of its panel; `right` is
/// set in a dim colour at the other end.
void heading(Pen& pen, const char* text, const std::string& right = {});

/// Text with its own font and colour; text_right ends at the right edge of the content.
void text(ImFont* font, ImU32 colour, const std::string& words);
void text_right(ImFont* font, ImU32 colour, const std::string& words);
/// The words, cut with an ellipsis to fit the width in this font.
std::string fitted(ImFont* font, const std::string& words, float width);
float text_width(ImFont* font, const std::string& words);

/// A small triangle that opens and closes a group. gives: true when it is clicked.
bool fold(Pen& pen, const std::string& name, bool open);

/// Words about the last item, once the mouse has rested on it for a moment; none after a click on
/// it until the mouse has left it, and none over a list that is unfolded.
void tooltip(Pen& pen, const char* words);

/// Buttons with a drawn sign.
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
  double typed = 1;    // the number that is typed, of a value of 1: 100 for a fraction shown in %
};
/// A field for a number of the width that was set for the next item, shown in a printf format. What
/// is typed stays in `draft` until Enter, Tab or a click elsewhere enters it. gives: true when
/// another number was entered.
bool number_field(Pen& pen, const char* name, double& value, const char* format,
                  std::optional<NumberEntry>& draft);

/// A flat slider: a thin bar with a round handle over `width`. gives: true while it changes.
/// Ctrl+click opens a field for the number instead; Enter takes it, within the slider's ends.
bool slider(Pen& pen, const char* name, double& value, const SliderLook& look);

/// A line of text to write in, with a hint while it is empty. gives: true when Enter is pressed.
bool text_field(Pen& pen, const char* name, std::string& words, float width, const char* hint);

/// Whether a list to choose from is unfolded, in front of any dialog; and folds it.
bool list_unfolded();
void fold_list();

/// A row of a list to choose from, filled while it is chosen. gives: true as the mouse goes down on
/// it, when Ctrl and Shift are as they are meant.
bool select_row(const std::string& label, bool chosen);

/// A box to tick with its label.
bool tick_box(Pen& pen, const char* name, const char* label, bool& on);

}  // namespace condyle
