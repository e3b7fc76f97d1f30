#include "render/window/panels/widgets.h"

#include <imgui_internal.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

namespace condyle {
namespace {

ImVec2 operator+(ImVec2 a, ImVec2 b) { return {a.x + b.x, a.y + b.y}; }

ImU32 ink(bool hovered, bool active) {
  return active ? palette().accent : hovered ? palette().bright : palette().text;
}

// A sign inside the square of side 2r about c.
void draw_sign(ImDrawList& list, Sign sign, ImVec2 c, float r, ImU32 ink_colour) {
  const auto at = [&](float x, float y) { return c + ImVec2{x * r, y * r}; };
  const float line = std::max(1.5f, r * 0.2f);
  const auto triangle = [&](float tip, float base) {  // pointing along x
    list.AddTriangleFilled(at(tip, 0), at(base, -0.8f), at(base, 0.8f), ink_colour);
  };
  switch (sign) {
    case Sign::play:
      list.AddTriangleFilled(at(-0.62f, -0.95f), at(1.0f, 0), at(-0.62f, 0.95f), ink_colour);
      break;
    case Sign::pause:
      list.AddRectFilled(at(-0.75f, -0.9f), at(-0.2f, 0.9f), ink_colour, r * 0.12f);
      list.AddRectFilled(at(0.2f, -0.9f), at(0.75f, 0.9f), ink_colour, r * 0.12f);
      break;
    case Sign::step_forward:
      triangle(0.5f, -0.8f);
      list.AddRectFilled(at(0.55f, -0.8f), at(0.85f, 0.8f), ink_colour);
      break;
    case Sign::step_back:
      triangle(-0.5f, 0.8f);
      list.AddRectFilled(at(-0.85f, -0.8f), at(-0.55f, 0.8f), ink_colour);
      break;
    case Sign::to_start:
      list.AddRectFilled(at(-1.0f, -0.8f), at(-0.72f, 0.8f), ink_colour);
      list.AddTriangleFilled(at(-0.7f, 0), at(0.15f, -0.8f), at(0.15f, 0.8f), ink_colour);
      list.AddTriangleFilled(at(0.1f, 0), at(0.95f, -0.8f), at(0.95f, 0.8f), ink_colour);
      break;
    case Sign::loop: {
      list.PathArcTo(c, r * 0.8f, -0.9f, 4.4f, 28);
      list.PathStroke(ink_colour, 0, line);
      const ImVec2 end = at(0.8f * std::cos(-0.9f), 0.8f * std::sin(-0.9f));
      list.AddTriangleFilled(end + ImVec2{-0.55f * r, -0.1f * r},
                             end + ImVec2{0.25f * r, -0.4f * r}, end + ImVec2{0.2f * r, 0.45f * r},
                             ink_colour);
      break;
    }
    case Sign::camera:
      list.AddRectFilled(at(-0.4f, -0.85f), at(0.4f, -0.4f), ink_colour, r * 0.15f);
      list.AddRect(at(-1, -0.6f), at(1, 0.8f), ink_colour, r * 0.25f, 0, line);
      list.AddCircle(at(0, 0.1f), r * 0.38f, ink_colour, 20, line);
      break;
    case Sign::help:
      break;  // a letter, drawn by the caller
    case Sign::close:
      list.AddLine(at(-0.7f, -0.7f), at(0.7f, 0.7f), ink_colour, line);
      list.AddLine(at(-0.7f, 0.7f), at(0.7f, -0.7f), ink_colour, line);
      break;
    case Sign::reset:
      list.AddTriangleFilled(at(0, -0.95f), at(-1, 0), at(1, 0), ink_colour);
      list.AddRectFilled(at(-0.65f, -0.1f), at(0.65f, 0.85f), ink_colour);
      break;
  }
}

}  // namespace

void Pen::mark(const std::string& name, const std::string& words) {
  // The first pass of a popup or tooltip only determines its size and is not shown.
  if (!ImGui::IsItemVisible() || ImGui::IsWindowAppearing()) return;
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  items.push_back({name, panel, {low.x, low.y, high.x - low.x, high.y - low.y}, words});
}

float width_of_each(const Pen& pen, float width, int count) {
  const float gaps = pen.px(button_gap) * static_cast<float>(count - 1);
  return std::floor((width - gaps) / static_cast<float>(count));
}

void begin_panel(Pen& pen, const char* name, const ViewRect& rect) {
  ImGui::SetNextWindowPos({static_cast<float>(rect.x), static_cast<float>(rect.y)});
  ImGui::SetNextWindowSize({static_cast<float>(rect.width), static_cast<float>(rect.height)});
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNavInputs |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoScrollWithMouse);
  const ImVec2 low = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  pen.panel = name;
  pen.items.push_back({name, "", {low.x, low.y, size.x, size.y}});
}

void end_panel() { ImGui::End(); }

float text_width(ImFont* font, const std::string& words) {
  return font->CalcTextSizeA(font->FontSize, 1e6f, 0, words.c_str()).x;
}

std::string fitted(ImFont* font, const std::string& words, float width) {
  if (text_width(font, words) <= width) return words;
  std::string cut = words;
  while (!cut.empty() && text_width(font, cut + "...") > width) {
    // Whole UTF-8 letters only.
    while (!cut.empty() && (static_cast<unsigned char>(cut.back()) & 0xc0) == 0x80) cut.pop_back();
    if (!cut.empty()) cut.pop_back();
  }
  return cut + "...";
}

namespace {

/// Wrapped between words only: ImGui also breaks numbers at their decimal point.
std::string broken(ImFont* font, const std::string& words, float width) {
  std::string lines, line;
  const auto add = [&](const std::string& word, char after) {
    const std::string longer = line.empty() ? word : line + " " + word;
    if (line.empty() || text_width(font, longer) <= width) {
      line = longer;
    } else {
      lines += line + "\n";
      line = word;
    }
    if (after == '\n') {
      lines += line + "\n";
      line.clear();
    }
  };
  std::string word;
  for (const char c : words) {
    if (c != ' ' && c != '\n') {
      word += c;
      continue;
    }
    add(word, c);
    word.clear();
  }
  add(word, ' ');
  return lines + line;
}

}  // namespace

void text(ImFont* font, ImU32 colour, const std::string& words) {
  ImGui::PushFont(font);
  const float wrap_at = ImGui::GetCurrentContext()->CurrentWindow->DC.TextWrapPos;
  if (wrap_at >= 0) {
    const float width = ImGui::CalcWrapWidthForPos(ImGui::GetCursorScreenPos(), wrap_at);
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::TextUnformatted(broken(font, words, width).c_str());
    ImGui::PopStyleColor();
    ImGui::PopFont();
    return;
  }
  ImGui::PushStyleColor(ImGuiCol_Text, colour);
  ImGui::TextUnformatted(words.c_str());
  ImGui::PopStyleColor();
  ImGui::PopFont();
}

void text_right(ImFont* font, ImU32 colour, const std::string& words) {
  const float right = ImGui::GetWindowContentRegionMax().x;
  ImGui::SetCursorPosX(std::max(0.0f, right - text_width(font, words)));
  text(font, colour, words);
}

void heading(Pen& pen, const char* words, const std::string& right) {
  const float top = ImGui::GetCursorPosY();
  if (top > ImGui::GetStyle().WindowPadding.y + 1) {
    ImGui::SetCursorPosY(top + pen.px(7));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::GetWindowDrawList()->AddLine(at, {at.x + ImGui::GetContentRegionAvail().x, at.y},
                                        palette().panel_edge, std::max(1.0f, pen.px(1)));
    ImGui::SetCursorPosY(top + pen.px(17));
  }
  text(pen.theme.bold, palette().text, words);
  pen.mark(std::string("heading:") + words);
  if (!right.empty()) {
    ImGui::SameLine();
    ImGui::SetCursorPosY(ImGui::GetCursorPosY() +
                         (pen.theme.bold->FontSize - pen.theme.small->FontSize) * 0.7f);
    text_right(pen.theme.small, palette().text_dim,
               fitted(pen.theme.small, right, ImGui::GetContentRegionAvail().x - pen.px(6)));
    pen.mark(std::string("beside-heading:") + words, right);
  }
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(2));
}

bool fold(Pen& pen, const std::string& name, bool open) {
  const float side = ImGui::GetFrameHeight();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const bool clicked = ImGui::InvisibleButton(("##" + name).c_str(), {pen.px(15), side});
  pen.mark(name);
  const float r = pen.px(4);
  const ImVec2 middle = {at.x + pen.px(5), at.y + side / 2};
  const ImU32 tint = ImGui::IsItemHovered() ? palette().text : palette().text_dim;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  if (open)
    list.AddTriangleFilled({middle.x - r, middle.y - r / 2}, {middle.x + r, middle.y - r / 2},
                           {middle.x, middle.y + r}, tint);
  else
    list.AddTriangleFilled({middle.x - r / 2, middle.y - r}, {middle.x + r, middle.y},
                           {middle.x - r / 2, middle.y + r}, tint);
  return clicked;
}

void tooltip(Pen& pen, const char* words) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  constexpr double wait_s = 0.5;
  TooltipWait& resting = pen.resting;
  const ImVec2 corner = ImGui::GetItemRectMin();
  const int pass = ImGui::GetFrameCount();
  const double now_s = ImGui::GetTime();
  if (corner.x != resting.x || corner.y != resting.y || pass > resting.last_pass + 1)
    resting = {.x = corner.x, .y = corner.y, .since_s = now_s};
  resting.last_pass = pass;
  if (ImGui::IsAnyMouseDown()) resting.put_away = true;
  if (resting.put_away) return;
  const bool waits = now_s - resting.since_s < wait_s;
  // ImGui determines the size of a tooltip in passes that do not show it yet.
  constexpr int unseen_passes = 3;
  if (!waits) resting.passes = std::min(resting.passes + 1, unseen_passes);
  resting.due = resting.passes < unseen_passes;
  if (waits) return;
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, pen.px(10, 7));
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(pen.px(300));
  text(pen.theme.small, palette().text, words);
  ImGui::PopTextWrapPos();
  const ImVec2 low = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  pen.items.push_back({"tooltip", "", {low.x, low.y, size.x, size.y}, words});
  ImGui::EndTooltip();
  ImGui::PopStyleVar();
}

bool sign_button(Pen& pen, const char* name, Sign sign, ImVec2 size, ImU32 background) {
  const bool pressed = ImGui::InvisibleButton(name, size);
  pen.mark(name);
  const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const ImVec2 centre = {(low.x + high.x) / 2, (low.y + high.y) / 2};
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImU32 fill =
      hovered && background == palette().field ? palette().field_hovered : background;
  list.AddRectFilled(low, high, fill, pen.px(5));
  if (hovered && background != palette().field)
    list.AddRectFilled(low, high, colour::rgb(0xffffff, 26), pen.px(5));
  const float r = std::min(size.x, size.y) * 0.24f;
  if (sign == Sign::help) {
    const ImVec2 extent = pen.theme.bold->CalcTextSizeA(pen.theme.bold->FontSize, 1e6f, 0, "?");
    list.AddText(pen.theme.bold, pen.theme.bold->FontSize,
                 {centre.x - extent.x / 2, centre.y - extent.y / 2}, ink(hovered, active), "?");
  } else {
    draw_sign(list, sign, centre, r, ink(hovered, active));
  }
  return pressed;
}

bool word_button(Pen& pen, const char* name, const char* label, ImVec2 size, bool on) {
  const bool pressed = ImGui::InvisibleButton(name, size);
  pen.mark(name);
  const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImU32 fill = on || active ? palette().accent_dark
                     : hovered    ? palette().field_hovered
                                  : palette().field;
  list.AddRectFilled(low, high, fill, pen.px(5));
  ImFont* font = pen.theme.regular;
  const ImVec2 extent = font->CalcTextSizeA(font->FontSize, 1e6f, 0, label);
  const bool usable = ImGui::GetStyle().Alpha >= 1;  // BeginDisabled lowers it
  list.AddText(
      font, font->FontSize,
      {std::round((low.x + high.x - extent.x) / 2), std::round((low.y + high.y - extent.y) / 2)},
      usable ? palette().text : palette().text_faint, label);
  return pressed;
}

namespace {

bool is_disabled() {
  return (ImGui::GetCurrentContext()->CurrentItemFlags & ImGuiItemFlags_Disabled) != 0;
}

/// Whether the slider is currently a field for its number.
bool typed_into(const char* name, const ImRect& rect) {
  const ImGuiID id = ImGui::GetCurrentWindow()->GetID(name);
  const ImGuiContext& now = *ImGui::GetCurrentContext();
  if (ImGui::TempInputIsActive(id)) return true;
  return now.IO.KeyCtrl && now.IO.MouseClicked[0] && now.HoveredWindow == now.CurrentWindow &&
         !is_disabled() && ImGui::IsMouseHoveringRect(rect.Min, rect.Max);
}

bool typed_number(Pen& pen, const char* name, const ImRect& rect, double& value,
                  const SliderLook& look) {
  const ImGuiID id = ImGui::GetCurrentWindow()->GetID(name);
  ImGui::ItemSize(rect.GetSize());
  if (!ImGui::ItemAdd(rect, id)) return false;
  ImGui::ItemHoverable(rect, id);
  std::array<char, 64> digits{};
  std::snprintf(digits.data(), digits.size(), "%.6g", value * look.typed);
  const double shown = std::strtod(digits.data(), nullptr);
  const bool entered =
      ImGui::TempInputText(rect, id, name, digits.data(), static_cast<int>(digits.size()),
                           ImGuiInputTextFlags_CharsScientific | ImGuiInputTextFlags_AutoSelectAll |
                               ImGuiInputTextFlags_EnterReturnsTrue);
  pen.mark(name);
  if (ImGui::IsItemActive()) pen.mark("writing");
  if (!entered) return false;
  char* end = nullptr;
  const double number = std::strtod(digits.data(), &end);
  if (end == digits.data() || !std::isfinite(number) || number == shown) return false;
  value = std::clamp(number / look.typed, look.low, look.high);
  return true;
}

}  // namespace

bool number_field(Pen& pen, const char* name, double& value, const char* format,
                  std::optional<NumberEntry>& draft) {
  double written = value;
  const bool changed =
      ImGui::InputDouble(("##" + std::string(name)).c_str(), &written, 0, 0, format,
                         ImGuiInputTextFlags_AutoSelectAll | ImGuiInputTextFlags_CharsScientific);
  const auto is_mine = [&] { return draft && draft->field == name; };
  // The field may have disappeared while being edited; another one may be entered in this pass.
  if (ImGui::IsItemActivated() && is_mine()) draft.reset();
  if (changed) draft = NumberEntry{name, written};
  const bool left = ImGui::IsItemDeactivated();
  std::array<char, 64> shown{};
  std::snprintf(shown.data(), shown.size(), format, value);
  pen.mark(name, shown.data());
  if (ImGui::IsItemActive()) pen.mark("writing");
  if (!left || !is_mine()) return false;
  const double entered = draft->number;
  draft.reset();
  if (entered == value || !std::isfinite(entered)) return false;
  value = entered;
  return true;
}

bool slider(Pen& pen, const char* name, double& value, const SliderLook& look) {
  const float height = ImGui::GetFrameHeight(), knob = pen.px(6.5f);
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImRect rect(corner, corner + ImVec2{look.width, height});
  if (typed_into(name, rect)) return typed_number(pen, name, rect, value, look);
  ImGui::InvisibleButton(name, {look.width, height});
  pen.mark(name);
  const ImVec2 low = ImGui::GetItemRectMin();
  const float span = std::max(1.0f, look.width - 2 * knob);
  const auto fraction_of = [&](double v) {
    const double f = look.logarithmic ? std::log(v / look.low) / std::log(look.high / look.low)
                                      : (v - look.low) / (look.high - look.low);
    return static_cast<float>(std::clamp(f, 0.0, 1.0));
  };
  bool changed = false;
  if (ImGui::IsItemActive()) {
    const double f = std::clamp((ImGui::GetIO().MousePos.x - low.x - knob) / span, 0.0f, 1.0f);
    const double chosen = look.logarithmic ? look.low * std::pow(look.high / look.low, f)
                                           : look.low + f * (look.high - look.low);
    // A click without motion also counts: the hand takes over.
    changed = chosen != value || ImGui::IsItemActivated();
    value = chosen;
  }
  const bool lit = ImGui::IsItemHovered() || ImGui::IsItemActive();
  const float y = low.y + height / 2, x = low.x + knob + span * fraction_of(value);
  const float thick = pen.px(2);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImU32 tint = is_disabled() ? palette().text_faint
                     : look.held   ? palette().warning
                                   : palette().accent;
  list.AddRectFilled({low.x, y - thick}, {low.x + look.width, y + thick}, palette().track, thick);
  if (look.filled) list.AddRectFilled({low.x, y - thick}, {x, y + thick}, tint, thick);
  list.AddCircleFilled({x, y}, lit ? knob : knob * 0.85f, lit ? palette().bright : tint, 24);
  return changed;
}

bool text_field(Pen& pen, const char* name, std::string& words, float width, const char* hint) {
  std::array<char, 1024> letters{};
  words.copy(letters.data(), letters.size() - 1);
  ImGui::SetNextItemWidth(width);
  const bool entered =
      ImGui::InputTextWithHint((std::string("##") + name).c_str(), hint, letters.data(),
                               letters.size(), ImGuiInputTextFlags_EnterReturnsTrue);
  pen.mark(name);
  if (ImGui::IsItemActive()) pen.mark("writing");
  words = letters.data();
  return entered;
}

bool select_row(const std::string& label, bool chosen) {
  const ImU32 lit = chosen ? palette().accent_dark : palette().field_hovered;
  ImGui::PushStyleColor(ImGuiCol_HeaderHovered, lit);
  const bool pressed = ImGui::Selectable(label.c_str(), chosen, ImGuiSelectableFlags_SelectOnClick);
  ImGui::PopStyleColor();
  return pressed;
}

bool list_unfolded() {
  const auto& open = ImGui::GetCurrentContext()->OpenPopupStack;
  return !open.empty() && open.back().Window &&
         (open.back().Window->Flags & ImGuiWindowFlags_Modal) == 0;
}

void fold_list() {
  if (list_unfolded())
    ImGui::ClosePopupToLevel(ImGui::GetCurrentContext()->OpenPopupStack.Size - 1, true);
}

bool tick_box(Pen& pen, const char* name, const char* label, bool& on) {
  ImFont* font = pen.theme.regular;
  const float side = pen.px(15), gap = pen.px(8);
  const float width = side + gap + text_width(font, label), height = ImGui::GetFrameHeight();
  const bool pressed = ImGui::InvisibleButton(name, {width, height});
  pen.mark(name);
  if (pressed) on = !on;
  const ImVec2 low = ImGui::GetItemRectMin();
  const float y = std::round(low.y + (height - side) / 2);
  const bool hovered = ImGui::IsItemHovered();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled({low.x, y}, {low.x + side, y + side},
                     on        ? palette().accent
                     : hovered ? palette().field_hovered
                               : palette().field,
                     pen.px(3));
  if (on) {
    const ImVec2 mark[3] = {{low.x + side * 0.22f, y + side * 0.52f},
                            {low.x + side * 0.43f, y + side * 0.74f},
                            {low.x + side * 0.80f, y + side * 0.28f}};
    list.AddPolyline(mark, 3, palette().panel, 0, pen.px(2));
  } else {
    list.AddRect({low.x, y}, {low.x + side, y + side}, palette().outline, pen.px(3));
  }
  list.AddText(font, font->FontSize,
               {low.x + side + gap, std::round(low.y + (height - font->FontSize) / 2)},
               on ? palette().text : palette().text_dim, label);
  return pressed;
}

}  // namespace condyle
