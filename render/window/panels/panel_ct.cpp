#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

constexpr float ct_column = 300, ct_button = 30;  // at scale 1

void wrapped(ImFont* font, ImU32 colour, const std::string& words) {
  ImGui::PushTextWrapPos(0);
  text(font, colour, words);
  ImGui::PopTextWrapPos();
}

}  // namespace

void Panels::Drawing::ct() {
  const CtView& ct = *input.scene.ct;
  PanelFormState::CtFields& form = panels.form_.ct;
  if (form.opened != ct.opened) {
    form = {.opened = ct.opened,
            .choice = ct.first,
            .asked = ct.first,
            .folder = ct.case_folder.string()};
  }
  if (form.series == 0 && ct.best >= 0)
    form.series = ct.series[static_cast<std::size_t>(ct.best)].number;

  const bool slices = ct.stage == CtStage::slices || ct.stage == CtStage::making;
  const double column = std::round(pen.px(ct_column)),
               gap = std::max(1.0, std::round(double{pen.px(1)}));
  ImGui::GetBackgroundDrawList()->AddRectFilled(
      {0, 0}, {static_cast<float>(display_width), static_cast<float>(display_height)},
      palette().window);  // in front of the patient
  begin_panel(pen, "ct", {0, 0, slices ? column : display_width, display_height});
  heading(pen, "CT");
  wrapped(panels.theme_.bold, palette().text, ct.name);
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(6));
  if (slices) {
    ct_controls();
  } else {
    ct_progress();
    ct_series(ImGui::GetContentRegionAvail().y - pen.px(90));
    ct_making();
  }
  end_panel();
  if (!slices) return;
  ct_pictures({column + gap, 0, display_width - column - gap, display_height});
  if (ct.stage == CtStage::slices && !(form.choice == form.asked))
    panels.request(request::ShowCt{form.asked = form.choice});
}

/// The series with their facts; a double click or the button below reads one.
void Panels::Drawing::ct_series(float high) {
  const CtView& ct = *input.scene.ct;
  PanelFormState::CtFields& form = panels.form_.ct;
  const Theme& theme = panels.theme_;
  if (ct.stage == CtStage::listing || (ct.stage == CtStage::reading && ct.series.size() < 2))
    return;
  text(theme.regular, palette().text_dim,
       ct.series.size() == 1
           ? "One series in this folder"
           : fmt::format("{} series in this folder: choose one", ct.series.size()));
  ImGui::PushStyleColor(ImGuiCol_ChildBg, palette().well);
  ImGui::BeginChild("ct-list", {0, std::max(pen.px(60), high - pen.px(20))}, false,
                    ImGuiWindowFlags_AlwaysUseWindowPadding);
  ImGui::BeginDisabled(ct.stage == CtStage::reading);
  for (std::size_t i = 0; i < ct.series.size(); ++i) {
    const CtSeriesItem& one = ct.series[i];
    const bool best = static_cast<int>(i) == ct.best;
    const std::string words =
        fmt::format("{}  {}{}", one.number, one.facts, best ? "  (best)" : "");
    ImGui::BeginDisabled(!one.readable && !one.uneven);
    if (select_row(fitted(theme.regular, words, ImGui::GetContentRegionAvail().x) + "##ct" +
                       std::to_string(one.number),
                   one.number == form.series)) {
      form.series = one.number;
      if (ImGui::IsMouseDoubleClicked(0) && one.readable)
        panels.request(request::ReadSeries{one.number});
    }
    pen.mark(fmt::format("ct-series:{}", one.number), words);
    ImGui::EndDisabled();
    for (const std::string& remark : one.remarks)
      wrapped(theme.small, one.readable ? palette().text_dim : palette().warning, "     " + remark);
  }
  ImGui::EndDisabled();
  for (const std::string& note : ct.notes) wrapped(theme.small, palette().text_dim, note);
  // Of a single series its own remarks say why.
  if (!ct.no_best.empty() && ct.series.size() != 1)
    wrapped(theme.small, palette().warning, ct.no_best);
  ImGui::EndChild();
  ImGui::PopStyleColor();
}

void Panels::Drawing::ct_controls() {
  const CtView& ct = *input.scene.ct;
  ImGui::BeginDisabled(ct.stage == CtStage::making);
  ct_threshold();
  ct_seeds();
  ImGui::EndDisabled();
  ct_making();
  if (ct.volume_notes.empty() || ImGui::GetContentRegionAvail().y < pen.px(40)) return;
  heading(pen, "Notes");
  ImGui::BeginChild("ct-notes", {0, 0});
  for (const std::string& note : ct.volume_notes)
    wrapped(panels.theme_.small, palette().text_dim, note);
  ImGui::EndChild();
}

void Panels::Drawing::ct_threshold() {
  const CtView& ct = *input.scene.ct;
  CtChoice& choice = panels.form_.ct.choice;
  heading(pen, "Bone", fmt::format("above {:.0f} HU", choice.threshold_hu));
  if (slider(pen, "ct-threshold", choice.threshold_hu,
             {.low = ct.lowest_hu,
              .high = ct.highest_hu,
              .width = ImGui::GetContentRegionAvail().x,
              .filled = false}))
    choice.threshold_hu = std::round(choice.threshold_hu);
  tooltip(pen,
          "Least Hounsfield units of bone, outlined in yellow. The surfaces are moved to the "
          "half-way level of each place later. Ctrl+click types a number");
  wrapped(panels.theme_.small, palette().text_dim, "Yellow: bone. Blue: skin.");
  const bool changed = choice.threshold_hu != ct.first.threshold_hu;
  ImGui::BeginDisabled(!changed);
  if (word_button(pen, "ct-threshold-reset",
                  fmt::format("From the histogram: {:.0f} HU", ct.first.threshold_hu).c_str(),
                  {ImGui::GetContentRegionAvail().x, pen.px(26)}, false))
    choice.threshold_hu = ct.first.threshold_hu;
  ImGui::EndDisabled();
}

void Panels::Drawing::ct_seeds() {
  PanelFormState::CtFields& form = panels.form_.ct;
  using Click = PanelFormState::CtFields::Click;
  auto& seeds = form.choice.seeds;
  heading(pen, "Seeds", seeds.empty() ? "" : fmt::format("{}", seeds.size()));
  wrapped(panels.theme_.small, palette().text_dim,
          form.click == Click::cross ? "Where the teeth touch, a few clicks on bone of each help "
                                       "to separate skull and lower jaw."
                                     : "Click on bone in a slice.");
  const std::string& remark = input.scene.ct->seed_remark;
  if (!remark.empty()) {
    wrapped(panels.theme_.small, palette().warning, remark);
    pen.mark("ct-seed-remark", remark);
  }
  const float gap = pen.px(button_gap);
  const ImVec2 half = {width_of_each(pen, ImGui::GetContentRegionAvail().x, 2), pen.px(26)};
  const auto tool = [&](const char* item, const char* label, Click click) {
    if (word_button(pen, item, label, half, form.click == click))
      form.click = form.click == click ? Click::cross : click;
  };
  tool("ct-seed-skull", "In the skull", Click::skull);
  ImGui::SameLine(0, gap);
  tool("ct-seed-jaw", "In the lower jaw", Click::jaw);
  ImGui::BeginDisabled(seeds.empty());
  if (word_button(pen, "ct-seed-undo", "Remove the last", half, false)) seeds.pop_back();
  ImGui::SameLine(0, gap);
  if (word_button(pen, "ct-seed-clear", "Remove all", half, false)) seeds.clear();
  ImGui::EndDisabled();
}

/// The last rows: progress, the folder of the patient, and the buttons.
void Panels::Drawing::ct_making() {
  const CtView& ct = *input.scene.ct;
  PanelFormState::CtFields& form = panels.form_.ct;
  const bool slices = ct.stage == CtStage::slices || ct.stage == CtStage::making;
  const float row = pen.px(ct_button), gap = pen.px(button_gap);
  const float whole = ImGui::GetContentRegionAvail().x;
  if (!slices) {
    ImGui::SetCursorPosY(ImGui::GetWindowContentRegionMax().y - row);
    const auto chosen = std::find_if(ct.series.begin(), ct.series.end(), [&](const auto& one) {
      return one.number == form.series && (one.readable || one.uneven);
    });
    const bool uneven = chosen != ct.series.end() && !chosen->readable;
    const float wide = pen.px(uneven ? 220 : 130);
    ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - pen.px(130) - wide - gap);
    if (word_button(pen, "ct-close", "Close the CT", {pen.px(130), row}, false))
      panels.request(request::CloseCt{});
    ImGui::SameLine(0, gap);
    ImGui::BeginDisabled(ct.stage != CtStage::series || chosen == ct.series.end());
    if (word_button(pen, "ct-read", uneven ? "Interpolate slices and read" : "Read the series",
                    {wide, row}, true))
      panels.request(request::ReadSeries{form.series, uneven});
    if (uneven)
      tooltip(pen,
              "Slices are missing or uneven: all are interpolated at the usual step between "
              "slices. Anatomy in a gap is a guess");
    ImGui::EndDisabled();
    return;
  }
  heading(pen, "Patient");
  if (ct.stage == CtStage::making) {
    wrapped(panels.theme_.small, palette().text_dim,
            "Bone, skin, jaws, teeth and landmarks are found; this takes a minute or two.");
    ct_progress();
    return;
  }
  wrapped(panels.theme_.small, palette().text_dim, "It is saved as a case in a new folder:");
  text_field(pen, "ct-folder", form.folder, whole, "folder of the patient");
  tooltip(pen, form.folder.c_str());
  ImGui::BeginDisabled(form.folder.empty());
  if (word_button(pen, "ct-make", "Make the patient", {whole, row}, true))
    panels.request(request::MakeCtPatient{form.folder});
  ImGui::EndDisabled();
  if (word_button(pen, "ct-close", "Close the CT", {whole, row}, false))
    panels.request(request::CloseCt{});
}

void Panels::Drawing::ct_progress() {
  if (input.progress.empty()) return;
  const float bar = pen.px(3), whole = ImGui::GetContentRegionAvail().x, button = pen.px(80);
  text(panels.theme_.regular, palette().text, fitted(panels.theme_.regular, input.progress, whole));
  pen.mark("ct-progress", input.progress);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float done = static_cast<float>(std::clamp(input.progress_fraction, 0.0, 1.0));
  list.AddRectFilled(at, {at.x + whole, at.y + bar}, palette().track, bar);
  list.AddRectFilled(at, {at.x + whole * done, at.y + bar}, palette().accent, bar);
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + pen.px(12));
  if (input.can_cancel && word_button(pen, "cancel", "Cancel", {button, pen.px(26)}, false))
    panels.request(request::Cancel{});
}

}  // namespace condyle
