#include "render/window/panels/panels.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>

#include "render/window/panels/panels_drawing.h"
#include "render/window/view/playback.h"

namespace condyle {
namespace {

constexpr double said_for_s = 6;
constexpr std::size_t curve_length = 120;

struct ViewButton {
  const char* letter;
  Command command;
  const char* tip;
};
constexpr std::array<ViewButton, 6> view_buttons = {{
    {"A", Command::view_front, "From the front (anterior). Key A or keypad 1"},
    {"P", Command::view_back, "From behind (posterior). Key P or Shift with keypad 1"},
    {"L", Command::view_left, "From the patient's left. Key L or keypad 3"},
    {"R", Command::view_right, "From the patient's right. Key R or Shift with keypad 3"},
    {"S", Command::view_above, "From above (superior). Key S or keypad 7"},
    {"I", Command::view_below, "From below (inferior). Key I or Shift with keypad 7"},
}};

/// A button of the top bar that chooses a tool.
struct ToolButton {
  const char* item;
  const char* label;
  const char* tip;
  Command command;
  bool on, there = true;
};

std::array<ToolButton, 5> tool_buttons(const PanelInput& input, const ViewState& view) {
  return {{ToolButton{"move-tool", "Move",
                      "Move the jaw and free bones by hand; they slide on contact. Key M",
                      Command::toggle_move, view.tool == Tool::move, !input.scene.bodies.empty()},
           ToolButton{"cut-tool", "Cut",
                      "Draw a saw cut on a bone; it becomes a step of the plan. Key C",
                      Command::toggle_cut, view.tool == Tool::cut},
           ToolButton{"measure-tool", "Measure",
                      "Distances, angles and areas between points on bone, teeth and skin. Key N",
                      Command::toggle_measure, view.tool == Tool::measure},
           ToolButton{"landmarks-tool", "Landmarks",
                      "Named points of the patient: place, rename, save. Key B",
                      Command::toggle_landmarks, view.tool == Tool::landmarks},
           ToolButton{"plots-tool", "Plots",
                      "Posselt, axiography, opening, clearance and more, as the motion runs. Key G",
                      Command::toggle_plots, view.plots}}};
}

/// What two states of the settings differ in, for people.
const char* edit_name(const Edits& a, const Edits& b) {
  if (!(a.hands == b.hands) || a.opening_mm != b.opening_mm) return "a move by hand";
  if (!(a.drawn_cut == b.drawn_cut)) return "a point of the cut";
  if (a.measured != b.measured) return "a measured point";
  if (a.landmarks != b.landmarks) return "a landmark";
  if (!(a.motion == b.motion)) return "the motion";
  if (a.expression != b.expression) return "the expression";
  if (a.parts != b.parts || a.muscles != b.muscles || a.layers != b.layers ||
      a.skin_opacity != b.skin_opacity)
    return "what is shown";
  if (!(a.look == b.look)) return "the look";
  return "a setting";
}

}  // namespace

std::string motion_title(const WindowScene& scene) {
  const std::string title = display_name(scene.motion_name);
  const bool built_in = std::any_of(scene.motions.begin(), scene.motions.end(),
                                    [&](const auto& name) { return display_name(name) == title; });
  return built_in ? title : scene.motion_name;
}

Panels::Panels(float scale, bool light) : theme_(apply_theme(scale, light)) {}

void Panels::set_scale(float scale) {
  if (scale != theme_.scale) theme_ = apply_theme(scale, theme_.light);
}

void Panels::set_light(bool light) {
  if (light != theme_.light) theme_ = apply_theme(theme_.scale, light);
}

void Panels::report_error(const Trouble& trouble) {
  form_.requested_cut.reset();
  // An error repeated in every frame is shown once.
  if (errors_.empty() || errors_.back() != trouble) errors_.push_back(trouble);
}

void Panels::say(const std::string& sentence) {
  said_ = sentence;
  said_until_ = -1;  // the clock is ImGui's: set at the next drawing
}

void Panels::request(Request request) {
  const auto is_preview = [](const Request& each) {
    return std::holds_alternative<request::PreviewCut>(each) ||
           std::holds_alternative<request::ShowCt>(each);
  };
  if (is_preview(request) && !requests_.empty() && requests_.back().index() == request.index())
    requests_.back() = std::move(request);
  else
    requests_.push_back(std::move(request));
}

void Panels::answer(std::size_t which) {
  if (auto& request = form_.question->answers.at(which).request)
    requests_.push_back(std::move(*request));
  form_.question.reset();
  form_.requested_cut.reset();
}

bool Panels::run(Command command, const WindowScene& scene, ViewState& view) {
  if (command == Command::close_dialog && form_.part_menu) {
    form_.part_menu.reset();
    return true;
  }
  return run_playing(command, scene, view) || run_showing(command, scene, view) ||
         run_tool(command, scene, view) || run_session(command, scene) || run_dialog(command);
}

bool Panels::run_playing(Command command, const WindowScene& scene, ViewState& view) {
  const double step = scene.step_s, duration = scene.duration_s;
  const auto steps = [&](double count) {
    if (view.jaw_is_held()) remember(view);  // the motion takes the jaw from the hand
    step_clock(view, count * step, duration, X_CM_);
    return true;
  };
  switch (command) {
    case Command::toggle_play:
      if (view.jaw_is_held()) remember(view);
      toggle_playing(view, duration, X_CM_);
      return true;
    case Command::step_back:
      return steps(-1);
    case Command::step_forward:
      return steps(1);
    case Command::jump_back:
      return steps(-10);
    case Command::jump_forward:
      return steps(10);
    default:
      return false;
  }
}

bool Panels::run_showing(Command command, const WindowScene& scene, ViewState& view) {
  switch (command) {
    case Command::toggle_skin:
      remember(view);
      view.skin_to_return.reset();
      if (view.skin_opacity > 0) {
        skin_before_ = view.skin_opacity;
        view.skin_opacity = 0;
      } else {
        view.skin_opacity = skin_before_;
      }
      return true;
    case Command::toggle_distances:
      if (!scene.distance_colours) return true;
      remember(view);
      view.distances = !view.distances;
      if (view.distances) view.look.displacement = false;  // one scale of colours at a time
      // They are shown on bones and teeth only: the skin is hidden until they are switched off. Key
      // K restores it earlier.
      if (view.distances && view.skin_opacity > 0.5) {
        view.skin_to_return = skin_before_ = view.skin_opacity;
        view.skin_opacity = 0;
      } else if (!view.distances) {
        view.return_skin();
      }
      return true;
    case Command::toggle_plots:
      view.plots = !view.plots;
      return true;
    case Command::toggle_panels:
      shown_ = !shown_;
      return true;
    default:
      return false;
  }
}

bool Panels::run_tool(Command command, const WindowScene& scene, ViewState& view) {
  const auto toggle = [&](Tool tool) {
    view.tool = view.tool == tool ? Tool::look : tool;
    return true;
  };
  switch (command) {
    case Command::toggle_move:
      return toggle(scene.bodies.empty() ? Tool::look : Tool::move);
    case Command::toggle_measure:
      return toggle(Tool::measure);
    case Command::toggle_landmarks:
      return toggle(Tool::landmarks);
    case Command::toggle_cut:
      return toggle(Tool::cut);
    case Command::accept:
      if (view.tool != Tool::cut || dialog_open() || list_unfolded()) return false;
      accept_cut(scene, view);
      return true;
    case Command::close_dialog:
      if (view.tool != Tool::cut || dialog_open() || list_unfolded()) return false;
      if (view.drawn_cut.points.empty()) return toggle(Tool::cut);
      remember(view);
      view.drawn_cut.points.clear();
      return true;
    case Command::undo:
    case Command::redo: {
      // Settings changed since the last edit of the plan come first.
      const bool back = command == Command::undo;
      if (undo(view, back)) return true;
      if (view.tool == Tool::cut && !view.drawn_cut.points.empty()) {
        if (back) view.drawn_cut.points.pop_back();
        return true;
      }
      if ((back ? scene.plan.undo : scene.plan.redo).empty())
        say(back ? "Nothing to undo" : "Nothing to redo");
      else if (back)
        request(request::EditPlan{plan_edit::Undo{}});
      else
        request(request::EditPlan{plan_edit::Redo{}});
      return true;
    }
    default:
      return false;
  }
}

bool Panels::run_dialog(Command command) {
  switch (command) {
    case Command::open_files:
      form_.files.open = true;
      form_.files.listed.clear();  // files may have changed
      return true;
    case Command::help:
      help_open_ = !help_open_;
      return true;
    case Command::accept:
      // Boxes with fields have a separate button for it.
      if (!errors_.empty()) {
        errors_.pop_front();
      } else if (form_.question) {
        answer(0);
      } else if (form_.session.open && !form_.import) {
        form_.session.accepted = true;
      } else if (form_.files.open && !form_.import) {
        form_.files.accepted = !form_.files.chosen.empty();
      } else if (help_open_ && !form_.import) {
        help_open_ = false;
      }
      return true;
    case Command::close_dialog:
      if (list_unfolded()) {
        fold_list_ = true;
      } else if (!errors_.empty()) {
        errors_.pop_front();
      } else if (form_.question) {
        if (auto& request = form_.question->unanswered) requests_.push_back(std::move(*request));
        form_.question.reset();
      } else if (form_.import) {
        form_.import.reset();
      } else if (form_.session.open) {
        form_.session.open = false;
      } else if (form_.files.open) {
        form_.files.open = false;
      } else {
        help_open_ = false;
      }
      return true;
    default:
      return false;
  }
}

bool Panels::takes(Command command) const {
  switch (command) {
    case Command::close_dialog:
    case Command::accept:
    case Command::picture:
    case Command::window_picture:
    case Command::quit:
      return true;
    case Command::open_files:
    case Command::toggle_theme:
      return !dialog_open();
    case Command::help:
      return !dialog_open() || (help_open_ && errors_.empty() && !form_.question);
    default:
      return !dialog_open() && !ct_open_;
  }
}

void Panels::forget_edits() {
  form_.part_menu.reset();
  form_.requested_cut.reset();
  history_ = {};
  editing_ = false;
}

void Panels::forget_patient() {
  forget_edits();
  skin_before_ = 1;
  form_.case_folder.clear();
  form_.landmark_words.clear();
  form_.plan = {};
  form_.part_menu.reset();
  form_.parameters.clear();
  form_.excitations.clear();
  form_.number.reset();
  record_.caption.clear();
  record_.camera_file.clear();
  record_.camera_from_file = false;
}

bool Panels::undo(ViewState& view, bool back) {
  const Edits before = view.edits();
  Edits now = before;
  if (!(back ? history_.undo(now) : history_.redo(now))) return false;
  say(std::string(back ? "Undone: " : "Redone: ") + edit_name(before, now));
  view.set_edits(std::move(now));
  undone_ = true;
  return true;
}

/// All changes of a pass over the panels form an edit; all during one drag form a single edit.
void Panels::remember_edits(const Edits& before, const ViewState& view) {
  const bool changed = !(view.edits() == before);
  if (changed && !undone_ && !editing_) history_.remember(before);
  editing_ = ImGui::IsAnyItemActive() && (editing_ || changed);
}

std::vector<Command> Panels::draw(const PanelInput& input, ViewState& view, double width,
                                  double height) {
  items_.clear();
  tooltip_.due = false;
  key_refused_ = key_refused_ && dialog_open();
  if (std::exchange(fold_list_, false)) fold_list();
  view.fit(input.scene);
  undone_ = false;
  const Edits before = view.edits();
  // It is in the timeline, which appears with the patient.
  if (said_until_ < 0 && !input.scene.parts.empty()) said_until_ = ImGui::GetTime() + said_for_s;
  if (said_until_ >= 0 && ImGui::GetTime() > said_until_) said_.clear();
  X_CM_ = input.frame ? input.frame->poses[view.hands.jaw] : Pose{};
  if (input.frame) {
    const std::uint64_t step =
        input.frame->state_hash ^ std::bit_cast<std::uint64_t>(input.frame->time_s);
    if (step != last_step_) {
      double total = 0;
      for (std::size_t i = 0; i < input.frame->times.ms.size(); ++i)
        if (static_cast<Stage>(i) != Stage::render) total += input.frame->times.ms[i];
      if (step_ms_.size() >= curve_length) step_ms_.erase(step_ms_.begin());
      step_ms_.push_back(static_cast<float>(total));
      if (stage_ms_.size() >= curve_length) stage_ms_.erase(stage_ms_.begin());
      stage_ms_.push_back(input.frame->times.ms);
      last_step_ = step;
    }
  }

  ImGui::PushFont(theme_.regular);
  // Without a patient only the progress of preparation is shown.
  const bool preparing = input.scene.parts.empty();
  Drawing drawing{
      *this,
      input,
      view,
      preparing ? lay_out(width, height, theme_.scale, false) : layout(width, height, view),
      width,
      height,
      Pen{theme_, items_, tooltip_, ""},
      {}};
  ct_open_ = input.scene.ct != nullptr;
  if (ct_open_) {
    drawing.ct();
    drawing.dialogs();
    ImGui::PopFont();
    return std::move(drawing.commands);
  }
  if (shown_ && !preparing) {
    drawing.top_bar();
    drawing.parts();
    drawing.side();
    drawing.timeline();
    drawing.plots();
    drawing.edges();
  }
  if (view.tool == Tool::move && !preparing) drawing.moving();
  if (!preparing) drawing.measuring();
  if (view.tool == Tool::landmarks && !preparing) drawing.landmarks();
  if (!preparing) drawing.cutting();
  if (!preparing) drawing.part_menu();
  drawing.view_signs();
  drawing.dialogs();
  ImGui::PopFont();
  remember_edits(before, view);
  return std::move(drawing.commands);
}

void Panels::Drawing::top_bar() {
  const Theme& theme = panels.theme_;
  const auto tools = tool_buttons(input, view);
  begin_panel(pen, "top", layout.top);
  const float side = pen.px(30), gap = pen.px(5), wide_gap = pen.px(16);
  const float y = (static_cast<float>(layout.top.height) - side) / 2;
  const auto width_of = [&](const char* words) {
    return text_width(theme.regular, words) + pen.px(22);
  };
  float buttons = side * 9 + gap * 6 + wide_gap * 2;
  for (const ToolButton& tool : tools)
    if (tool.there) buttons += width_of(tool.label) + gap;
  buttons += wide_gap - gap;
  const float right = static_cast<float>(layout.top.width) - pen.px(12);

  ImGui::SetCursorPos({pen.px(12), y});
  const float open_width = width_of("Open");
  if (word_button(pen, "open-files", "Open", {open_width, side}, false))
    panels.run(Command::open_files, input.scene, view);
  tooltip(
      pen,
      "A session, a patient, a motion, surfaces or a CT; they can also be dropped on the window. "
      "Ctrl+O");
  ImGui::SameLine(0, gap);
  const float save_width = width_of("Save");
  if (word_button(pen, "save-session", "Save", {save_width, side}, false))
    panels.run(Command::save_session_as, input.scene, view);
  tooltip(pen,
          "Saves the session: patient, plan, view, measures. Ctrl+S saves in the same file again");

  // Names, as far as space permits.
  const float from = pen.px(26) + open_width + gap + save_width;
  const float room = right - buttons - from - wide_gap;
  const std::string name = fitted(theme.bold, input.scene.case_name, room * 0.6f);
  ImGui::SetCursorPos({from, (static_cast<float>(layout.top.height) - theme.bold->FontSize) / 2});
  text(theme.bold, palette().text, name);
  if (!input.scene.motion_name.empty()) {
    const float used = text_width(theme.bold, name) + pen.px(14);
    ImGui::SameLine(0, pen.px(14));
    text(theme.regular, palette().text_dim,
         fitted(theme.regular, motion_title(input.scene), room - used));
    pen.mark("motion-title", motion_title(input.scene));
  }

  ImGui::SetCursorPos({right - buttons, y});
  for (const ToolButton& tool : tools) {
    if (!tool.there) continue;
    if (word_button(pen, tool.item, tool.label, {width_of(tool.label), side}, tool.on))
      panels.run(tool.command, input.scene, view);
    tooltip(pen, tool.tip);
    ImGui::SameLine(0, &tool == &tools.back() ? wide_gap : gap);
  }
  for (const ViewButton& button : view_buttons) {
    const std::string id = std::string("view:") + button.letter;
    if (word_button(pen, id.c_str(), button.letter, {side, side}, false))
      commands.push_back(button.command);
    tooltip(pen, button.tip);
    ImGui::SameLine(0, gap);
  }
  if (sign_button(pen, "view:home", Sign::reset, {side, side}, palette().field))
    commands.push_back(Command::reset_view);
  tooltip(pen, "The first view again. Key 0 or Home");
  ImGui::SameLine(0, wide_gap);
  if (sign_button(pen, "picture", Sign::camera, {side, side}, palette().field))
    commands.push_back(Command::picture);
  tooltip(pen, "Save the picture as PNG. F12; with Shift the whole window");
  ImGui::SameLine(0, wide_gap);
  if (sign_button(pen, "help-button", Sign::help, {side, side}, palette().field))
    panels.help_open_ = true;
  tooltip(pen, "Keys and mouse. F1");
  end_panel();
}

}  // namespace condyle
