#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr ImU32 cross_tint = colour::rgb(0x56b4e9, 200), skull_tint = colour::rgb(0xe69f00),
                jaw_tint = colour::rgb(0x2fbf93), dark_edge = colour::rgb(0x0f1215, 220),
                ct_letter = colour::rgb(0xc4ccd4);
constexpr double seed_reach_mm = 4;  // of a slice, within which seeds are drawn
constexpr const char* slice_items[] = {"ct-axial", "ct-coronal", "ct-sagittal"};

/// The largest rectangle of these proportions in the middle of a place.
ViewRect fitted_rect(const ViewRect& place, double width, double height) {
  const double scale = std::min(place.width / width, place.height / height);
  const double w = width * scale, h = height * scale;
  return {place.x + (place.width - w) / 2, place.y + (place.height - h) / 2, w, h};
}

/// Between pixels of the window and mm of the patient.
struct SliceMap {
  const CtSliceView& slice;
  ViewRect rect;
  double pixels_per_mm() const { return rect.width / slice.width_mm; }
  ImVec2 pixel(const Vector3d& p) const {
    const Vector3d from = p - slice.corner;
    return {static_cast<float>(rect.x + from.dot(slice.right) * pixels_per_mm()),
            static_cast<float>(rect.y + from.dot(slice.down) * pixels_per_mm())};
  }
  /// The place in the slice; `across` keeps its distance from the slice's first corner.
  Vector3d place(ImVec2 at) const {
    const double x = std::clamp(at.x - rect.x, 0.0, rect.width) / pixels_per_mm(),
                 y = std::clamp(at.y - rect.y, 0.0, rect.height) / pixels_per_mm();
    return slice.corner + x * slice.right + y * slice.down;
  }
  double off_mm(const Vector3d& p) const {
    return std::abs((p - slice.corner).dot(slice.step.normalized()));
  }
};

void letters(ImDrawList& list, const Theme& theme, const ViewRect& place,
             const std::array<std::string, 4>& sides, float margin) {
  const auto put = [&](const std::string& words, double x, double y) {
    const ImVec2 size = theme.bold->CalcTextSizeA(theme.bold->FontSize, 1e6f, 0, words.c_str());
    const ImVec2 at = {static_cast<float>(x) - size.x / 2, static_cast<float>(y) - size.y / 2};
    for (const auto& [dx, dy] : {std::pair{-1.f, 0.f}, {1.f, 0.f}, {0.f, -1.f}, {0.f, 1.f}})
      list.AddText(theme.bold, theme.bold->FontSize, {at.x + dx, at.y + dy}, dark_edge,
                   words.c_str());
    list.AddText(theme.bold, theme.bold->FontSize, at, ct_letter, words.c_str());
  };
  const double cx = place.x + place.width / 2, cy = place.y + place.height / 2, m = margin;
  put(sides[0], place.x + m, cy);
  put(sides[1], place.x + place.width - m, cy);
  put(sides[2], cx, place.y + m);
  put(sides[3], cx, place.y + place.height - m);
}

}  // namespace

/// Three slices and the solid, in four panes.
void Panels::Drawing::ct_pictures(const ViewRect& place) {
  const CtView& ct = *input.scene.ct;
  PanelFormState::CtFields& form = panels.form_.ct;
  const CtChoice before = form.choice;
  const double gap = std::max(1.0, std::round(double{pen.px(1)}));
  const double wide = std::floor((place.width - gap) / 2),
               high = std::floor((place.height - gap) / 2);
  for (std::size_t i = 0; i < 4; ++i) {
    const ViewRect pane = {place.x + static_cast<double>(i % 2) * (wide + gap),
                           place.y + static_cast<double>(i / 2) * (high + gap), wide, high};
    if (i < 3)
      ct_slice(i, pane);
    else
      ct_solid(pane);
  }
  if (ct.stage == CtStage::making) form.choice = before;
}

void Panels::Drawing::ct_slice(std::size_t which, const ViewRect& pane) {
  const CtView& ct = *input.scene.ct;
  const CtSliceView& slice = ct.slices[which];
  PanelFormState::CtFields& form = panels.form_.ct;
  using Click = PanelFormState::CtFields::Click;
  ImGui::PushStyleColor(ImGuiCol_WindowBg, colour::rgb(0x000000));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2{0, 0});
  begin_panel(pen, slice_items[which], pane);
  const SliceMap map{slice, fitted_rect(pane, slice.width_mm, slice.height_mm)};
  const ViewRect& r = map.rect;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 low = {static_cast<float>(r.x), static_cast<float>(r.y)},
               high = {static_cast<float>(r.x + r.width), static_cast<float>(r.y + r.height)};
  if (input.ct_pictures[which] != 0)
    list.AddImage(reinterpret_cast<ImTextureID>(input.ct_pictures[which]), low, high);
  ImGui::SetCursorPos({0, 0});
  ImGui::InvisibleButton("slice",
                         {static_cast<float>(pane.width), static_cast<float>(pane.height)});
  const ImGuiIO& io = ImGui::GetIO();
  const bool hovered = ImGui::IsItemHovered();
  const Vector3d across = slice.step.normalized();
  if (ImGui::IsItemActive()) {
    if (form.click == Click::cross) {
      const Vector3d at = map.place(io.MousePos);
      form.choice.cross = at + across * across.dot(form.choice.cross - at);
    } else if (ImGui::IsItemActivated()) {
      form.choice.seeds.push_back({map.place(io.MousePos), form.click == Click::jaw});
    }
  }
  if (hovered && io.MouseWheel != 0) {
    // From the chosen slice: the one that is drawn may be an earlier one.
    const double ahead = (form.choice.cross - slice.corner).dot(across) / slice.step.norm();
    const double number = std::clamp<double>(slice.number + std::round(ahead), 1, slice.count);
    const double steps =
        std::clamp<double>(std::round(io.MouseWheel), 1 - number, slice.count - number);
    form.choice.cross = form.choice.cross + steps * slice.step;
  }
  // The crosshair, with a gap in its middle.
  const ImVec2 c = map.pixel(form.choice.cross);
  const float hole = pen.px(8), line = std::max(1.0f, pen.px(1));
  list.AddLine({low.x, c.y}, {c.x - hole, c.y}, cross_tint, line);
  list.AddLine({c.x + hole, c.y}, {high.x, c.y}, cross_tint, line);
  list.AddLine({c.x, low.y}, {c.x, c.y - hole}, cross_tint, line);
  list.AddLine({c.x, c.y + hole}, {c.x, high.y}, cross_tint, line);
  for (const CtSeed& seed : form.choice.seeds) {
    if (map.off_mm(seed.position) > seed_reach_mm) continue;
    const ImVec2 p = map.pixel(seed.position);
    list.AddCircleFilled(p, pen.px(6), dark_edge, 20);
    list.AddCircleFilled(p, pen.px(4.5f), seed.in_jaw ? jaw_tint : skull_tint, 20);
  }
  letters(list, panels.theme_, pane, slice.sides, pen.px(14));
  const std::string words = fmt::format("{}  {} / {}", slice.name, slice.number, slice.count);
  list.AddText(panels.theme_.small, panels.theme_.small->FontSize,
               {static_cast<float>(pane.x) + pen.px(8), static_cast<float>(pane.y) + pen.px(6)},
               ct_letter, words.c_str());
  pen.items.push_back({std::string(slice_items[which]) + ":slice",
                       slice_items[which],
                       {r.x, r.y, r.width, r.height},
                       words});
  end_panel();
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
}

/// The bone as a solid; dragging turns it.
void Panels::Drawing::ct_solid(const ViewRect& pane) {
  PanelFormState::CtFields& form = panels.form_.ct;
  ImGui::PushStyleColor(ImGuiCol_WindowBg, colour::rgb(0x14181c));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2{0, 0});
  begin_panel(pen, "ct-solid", pane);
  const ViewRect r = fitted_rect(pane, 1, 1);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  if (input.ct_pictures[3] != 0)
    list.AddImage(reinterpret_cast<ImTextureID>(input.ct_pictures[3]),
                  {static_cast<float>(r.x), static_cast<float>(r.y)},
                  {static_cast<float>(r.x + r.width), static_cast<float>(r.y + r.height)});
  ImGui::SetCursorPos({0, 0});
  ImGui::InvisibleButton("solid",
                         {static_cast<float>(pane.width), static_cast<float>(pane.height)});
  const ImGuiIO& io = ImGui::GetIO();
  if (ImGui::IsItemActive() && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) {
    constexpr double degrees_across = 240;
    form.choice.turn_deg =
        std::remainder(form.choice.turn_deg - io.MouseDelta.x / r.width * degrees_across, 360);
    form.choice.tilt_deg =
        std::clamp(form.choice.tilt_deg + io.MouseDelta.y / r.height * degrees_across, -89.0, 89.0);
  }
  list.AddText(panels.theme_.small, panels.theme_.small->FontSize,
               {static_cast<float>(pane.x) + pen.px(8), static_cast<float>(pane.y) + pen.px(6)},
               ct_letter, "Bone; drag to turn");
  end_panel();
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
}

}  // namespace condyle
