#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

constexpr float plan_number_width = 84, plan_row_high = 26;  // at scale 1

const char* number_format(const PlanNumber& number) {
  return number.unit == "mm" ? "%.1f mm" : number.unit == "deg" ? "%.1f\u00b0" : "%g";
}

void wrapped(ImFont* font, ImU32 colour, const std::string& words) {
  ImGui::PushTextWrapPos(0);
  text(font, colour, words);
  ImGui::PopTextWrapPos();
}

/// A list whose choice is carried out at once. Returns the chosen name; empty: none.
std::string choice(Pen& pen, const char* name, const char* label,
                   const std::vector<NamedItem>& items) {
  std::string chosen;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  ImGui::BeginDisabled(items.empty());
  if (ImGui::BeginCombo((std::string("##") + name).c_str(), label, ImGuiComboFlags_HeightLarge)) {
    for (const NamedItem& item : items) {
      if (ImGui::Selectable(item.label.c_str())) chosen = item.name;
      pen.mark(std::string(name) + ":" + item.name);
    }
    ImGui::EndCombo();
  }
  pen.mark(name);
  ImGui::EndDisabled();
  return chosen;
}

}  // namespace

void Panels::Drawing::edit_plan(PlanEdit edit) {
  panels.requests_.emplace_back(request::EditPlan{std::move(edit)});
}

void Panels::Drawing::plan() {
  const PlanView& plan = input.scene.plan;
  heading(pen, "Plan", plan.file.empty() ? "not saved" : plan.file.filename().string());
  const float foot = 2 * pen.px(plan_row_high) + pen.px(18);
  ImGui::BeginChild("plan-list",
                    {0, std::max(pen.px(60), ImGui::GetContentRegionAvail().y - foot)});
  plan_steps();
  plan_additions();
  plan_results();
  ImGui::EndChild();
  plan_buttons();
}

void Panels::Drawing::plan_steps() {
  const Theme& theme = panels.theme_;
  auto& form = panels.form_.plan;
  const auto& steps = input.scene.plan.steps;
  if (steps.empty())
    wrapped(theme.small, palette().text_dim,
            "No steps yet. Add an osteotomy, then move the segments that it makes.");
  int with_handles = 0;
  for (const PlanStepView& step : steps) {
    const bool chosen = form.step == step.id;
    if (chosen && step.is_cut) with_handles = step.id;
    if (select_row(fmt::format("{}  {}##step{}", step.id, step.title, step.id), chosen))
      form.step = chosen ? 0 : step.id;
    pen.mark(fmt::format("plan-step:{}", step.id), step.title);
    if (step.warns) {
      ImGui::SameLine();
      text_right(theme.regular, palette().warning, "!");
    }
    if (chosen)
      plan_step(step);
    else
      text(theme.small, palette().text_dim,
           fitted(theme.small, "    " + step.details, ImGui::GetContentRegionAvail().x));
  }
  if (std::exchange(form.with_handles, with_handles) != with_handles)
    panels.request(request::ShowHandles{with_handles});
}

/// The selected step: its numbers, what it does, and buttons.
void Panels::Drawing::plan_step(const PlanStepView& step) {
  const Theme& theme = panels.theme_;
  ImGui::Indent(pen.px(10));
  plan_numbers(step);
  if (step.numbers.empty()) wrapped(theme.small, palette().text_dim, step.details);
  // While a handle is dragged: what the cut would do at its new place.
  if (view.held_handle && view.tool != Tool::cut && input.scene.plan.preview) {
    cut_findings();
  } else {
    for (const std::string& finding : step.findings)
      wrapped(theme.small, step.warns ? palette().warning : palette().text_dim, finding);
  }
  const auto& steps = input.scene.plan.steps;
  const float gap = pen.px(button_gap);
  const ImVec2 size = {width_of_each(pen, ImGui::GetContentRegionAvail().x, 3),
                       pen.px(plan_row_high)};
  ImGui::BeginDisabled(steps.front().id == step.id);
  if (word_button(pen, "plan-earlier", "Earlier", size, false))
    edit_plan(plan_edit::Shift{step.id, false});
  ImGui::EndDisabled();
  ImGui::SameLine(0, gap);
  ImGui::BeginDisabled(steps.back().id == step.id);
  if (word_button(pen, "plan-later", "Later", size, false))
    edit_plan(plan_edit::Shift{step.id, true});
  ImGui::EndDisabled();
  ImGui::SameLine(0, gap);
  if (word_button(pen, "plan-remove", "Remove", size, false)) edit_plan(plan_edit::Remove{step.id});
  ImGui::Unindent(pen.px(10));
  ImGui::Dummy(pen.px(1, 4));
}

void Panels::Drawing::plan_numbers(const PlanStepView& step) {
  const Theme& theme = panels.theme_;
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, pen.px(8, 2));
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, pen.px(8, 3));
  for (const PlanNumber& number : step.numbers) {
    const float whole = ImGui::GetContentRegionAvail().x;
    const bool standard = number.value == number.standard;
    ImGui::AlignTextToFramePadding();
    text(theme.regular, standard ? palette().text_dim : palette().text,
         fitted(theme.regular, number.label, whole - pen.px(plan_number_width + 8)));
    ImGui::SameLine(ImGui::GetCursorPosX() + whole - pen.px(plan_number_width));
    ImGui::SetNextItemWidth(pen.px(plan_number_width));
    double value = number.value;
    const std::string name = fmt::format("plan-number:{}", number.name);
    if (number_field(pen, name.c_str(), value, number_format(number), panels.form_.number))
      edit_plan(
          plan_edit::SetNumber{step.id, number.name, std::clamp(value, number.low, number.high)});
    std::string help =
        fmt::format("{}\n{:g} to {:g} {}", number.help, number.low, number.high, number.unit);
    if (!standard) help += fmt::format("; standard {:g}", number.standard);
    tooltip(pen, help.c_str());
  }
  ImGui::PopStyleVar(2);
}

void Panels::Drawing::plan_additions() {
  const PlanView& plan = input.scene.plan;
  heading(pen, "Add");
  if (const auto name = choice(pen, "plan-osteotomy", "Osteotomy", plan.osteotomies); !name.empty())
    edit_plan(plan_edit::AddOsteotomy{name});
  tooltip(pen, "Placed from landmarks and the bone's shape; its numbers can be changed afterwards");
  if (const auto name = choice(pen, "plan-move", "Move of a segment", plan.segments); !name.empty())
    edit_plan(plan_edit::AddMove{name});
  tooltip(pen, "In millimetres and degrees, from where the segment lay before the operation");
  if (const auto name = choice(pen, "plan-occlude", "Final bite of", plan.arches); !name.empty())
    edit_plan(plan_edit::Occlude{name});
  tooltip(pen, "Places a segment that carries one dental arch in maximum intercuspation");
  if (!plan.trimmed.empty()) {
    if (const auto name = choice(pen, "plan-trim", "Trim", plan.trimmed); !name.empty())
      edit_plan(plan_edit::Trim{name});
    tooltip(pen, "Removes the bone of this segment that overlaps others, as the surgeon burrs it");
  }
  plan_graft_additions();
  const bool held = std::any_of(
      input.scene.bodies.begin(), input.scene.bodies.end(),
      [&](const MovableBody& body) { return body.roams() && view.hands.at(body.body); });
  ImGui::BeginDisabled(!held);
  if (word_button(pen, "plan-take", "Add the moves by hand",
                  {ImGui::GetContentRegionAvail().x, pen.px(plan_row_high)}, held))
    edit_plan(plan_edit::TakePositions{});
  ImGui::EndDisabled();
  tooltip(pen, "Segments that were dragged (key M) get these positions in the plan");
}

void Panels::Drawing::plan_graft_additions() {
  const PlanView& plan = input.scene.plan;
  if (!plan.resectable.empty()) {
    if (const auto name = choice(pen, "plan-resect", "Resect", plan.resectable); !name.empty())
      edit_plan(plan_edit::Resect{name});
    tooltip(pen, "Removes a segment with the teeth that it carries");
  }
  for (const NamedItem& resected : plan.replaceable) {
    const std::string label = "Graft for " + resected.label;
    if (const auto donor =
            choice(pen, ("plan-graft:" + resected.name).c_str(), label.c_str(), plan.donors);
        !donor.empty())
      edit_plan(plan_edit::Graft{resected.name, donor});
    tooltip(pen,
            "Bone from a donor in the place of the resected segment; then choose the number of "
            "pieces");
  }
}

void Panels::Drawing::plan_splints() {
  const PlanView& plan = input.scene.plan;
  if (plan.splints.empty()) return;
  if (const auto name = choice(pen, "plan-splint", "Make a splint", plan.splints); !name.empty())
    panels.request(request::MakeSplint{name});
  tooltip(pen, "Between the arches at their planned positions; saved as STL beside the plan");
  if (plan.splint_findings.empty()) return;
  for (const std::string& finding : plan.splint_findings) {
    wrapped(panels.theme_.small, palette().text_dim, finding);
    if (&finding == &plan.splint_findings.front()) pen.mark("splint-findings", finding);
  }
  if (word_button(pen, "splint-hide", "Hide the splint",
                  {ImGui::GetContentRegionAvail().x, pen.px(plan_row_high)}, false))
    panels.request(request::HideSplint{});
}

/// Overlaps, and tables that unfold.
void Panels::Drawing::plan_results() {
  const Theme& theme = panels.theme_;
  const PlanView& plan = input.scene.plan;
  auto& form = panels.form_.plan;
  if (plan.steps.empty()) return;
  heading(pen, "Result");
  for (const std::string& finding : plan.findings) wrapped(theme.small, palette().warning, finding);
  plan_splints();
  if (plan_table("displacements", "Displacement of bone", plan.displacements))
    form.displacements = !form.displacements;
  if (form.displacements)
    for (const PlanMeasure& row : plan.displacements) {
      text(theme.small, palette().text, row.label);
      ImGui::SameLine();
      text_right(theme.small, palette().text_dim, row.after);
      pen.mark("plan-displacement:" + row.label, row.after);
    }
  if (plan_table("cephalometry", "Cephalometry", plan.cephalometry))
    form.cephalometry = !form.cephalometry;
  if (form.cephalometry)
    for (const PlanMeasure& row : plan.cephalometry) {
      const std::string values =
          row.before == row.after ? row.after : row.before + " \u2192 " + row.after;
      text(theme.small, palette().text,
           fitted(theme.small, row.label,
                  ImGui::GetContentRegionAvail().x - text_width(theme.small, values) - pen.px(6)));
      ImGui::SameLine();
      text_right(theme.small, row.before == row.after ? palette().text_dim : palette().text,
                 values);
      pen.mark("plan-measure:" + row.label, values);
      tooltip(pen, fmt::format("Norm of European adults: {}", row.norm).c_str());
    }
}

/// The heading of a table that unfolds. Returns true when clicked.
bool Panels::Drawing::plan_table(const char* name, const char* title,
                                 const std::vector<PlanMeasure>& rows) {
  if (rows.empty()) return false;
  auto& form = panels.form_.plan;
  const bool open = name == std::string("displacements") ? form.displacements : form.cephalometry;
  const bool clicked = fold(pen, std::string("plan-") + name, open);
  ImGui::SameLine();
  text(panels.theme_.regular, palette().text, title);
  return clicked;
}

void Panels::Drawing::plan_buttons() {
  const PlanView& plan = input.scene.plan;
  auto& form = panels.form_.plan;
  const float gap = pen.px(button_gap), whole = ImGui::GetContentRegionAvail().x;
  const ImVec2 size = {width_of_each(pen, whole, 3), pen.px(plan_row_high)};
  ImGui::BeginDisabled(plan.undo.empty());
  if (word_button(pen, "plan-undo", "Undo", size, false)) edit_plan(plan_edit::Undo{});
  ImGui::EndDisabled();
  if (!plan.undo.empty()) tooltip(pen, ("Undo: " + plan.undo).c_str());
  ImGui::SameLine(0, gap);
  ImGui::BeginDisabled(plan.redo.empty());
  if (word_button(pen, "plan-redo", "Redo", size, false)) edit_plan(plan_edit::Redo{});
  ImGui::EndDisabled();
  if (!plan.redo.empty()) tooltip(pen, ("Redo: " + plan.redo).c_str());
  ImGui::SameLine(0, gap);
  if (form.file.empty() || form.known != plan.file) {
    form.file = plan.file.empty() ? "plan.json" : plan.file.string();
    form.known = plan.file;
  }
  const bool there = form.file == plan.file.string();
  ImGui::BeginDisabled(there || plan.steps.empty());
  if (word_button(pen, "plan-save", there ? "Saved" : "Save", size, !there && !plan.steps.empty()))
    panels.requests_.emplace_back(request::SavePlan{form.file});
  ImGui::EndDisabled();
  tooltip(pen, "Later edits are saved in the same file at once");
  text_field(pen, "plan-file", form.file, whole, "file of the plan");
}

}  // namespace condyle
