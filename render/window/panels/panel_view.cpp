#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "render/overlay/annotations.h"
#include "render/window/panels/panels_drawing.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

struct Face {
  const char* letter;
  Vector3d normal, up;
  Command command;
};

const std::array<Face, 6>& faces() {
  static const std::array<Face, 6> all = {{
      {"L", {1, 0, 0}, {0, 0, 1}, Command::view_left},
      {"R", {-1, 0, 0}, {0, 0, 1}, Command::view_right},
      {"P", {0, 1, 0}, {0, 0, 1}, Command::view_back},
      {"A", {0, -1, 0}, {0, 0, 1}, Command::view_front},
      {"S", {0, 0, 1}, {0, 1, 0}, Command::view_above},
      {"I", {0, 0, -1}, {0, -1, 0}, Command::view_below},
  }};
  return all;
}

// Letters of an anatomical direction, the strongest first: "L", or "LA" between two.
std::string direction_letters(const Vector3d& direction) {
  std::array<std::pair<double, const char*>, 3> axes;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    axes[k] = {std::abs(direction[i]), faces()[2 * k + (direction[i] < 0)].letter};
  }
  std::sort(axes.begin(), axes.end(), [](auto a, auto b) { return a.first > b.first; });
  std::string letters = axes[0].second;
  if (axes[1].first > 0.38) letters += axes[1].second;
  return letters;
}

ImU32 between(ImU32 from, ImU32 to, double fraction) {
  const ImVec4 a = ImGui::ColorConvertU32ToFloat4(from), b = ImGui::ColorConvertU32ToFloat4(to);
  const auto at = static_cast<float>(fraction);
  const auto mix = [at](float p, float q) { return p + at * (q - p); };
  return ImGui::ColorConvertFloat4ToU32(
      {mix(a.x, b.x), mix(a.y, b.y), mix(a.z, b.z), mix(a.w, b.w)});
}

bool inside(const std::array<ImVec2, 4>& quad, ImVec2 p) {
  bool any_left = false, any_right = false;
  for (std::size_t i = 0; i < 4; ++i) {
    const ImVec2 a = quad[i], b = quad[(i + 1) % 4];
    const float side = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
    any_left |= side > 0;
    any_right |= side < 0;
  }
  return !(any_left && any_right);
}

}  // namespace

void Panels::Drawing::view_signs() {
  const Theme& theme = panels.theme_;
  const ViewRect& r = layout.view;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ImVec2 centre = {static_cast<float>(r.x + r.width / 2),
                         static_cast<float>(r.y + r.height / 2)};

  progress();
  if (input.scene.parts.empty()) {
    const auto line = [&](ImFont* font, ImU32 tint, const char* words, float y) {
      list.AddText(font, font->FontSize, {centre.x - text_width(font, words) / 2, y}, tint, words);
    };
    line(theme.large, palette().text, "Condyle", centre.y - pen.px(110));
    line(theme.small, palette().text_dim, purpose, static_cast<float>(r.height) - pen.px(30));
    if (!input.progress.empty()) return;
    line(theme.regular, palette().text_dim,
         "Open a patient, or drop its folder, surfaces or CT here", centre.y - pen.px(50));
    const float wide = pen.px(96), high = pen.px(32);
    ImGui::PushStyleColor(ImGuiCol_WindowBg, colour::rgb(0, 0));
    begin_panel(pen, "start",
                {std::round(centre.x - wide / 2), std::round(centre.y - pen.px(16)), wide, high});
    ImGui::SetCursorPos({0, 0});
    if (word_button(pen, "open-files", "Open", {wide, high}, true))
      panels.run(Command::open_files, input.scene, view);
    tooltip(pen, "Ctrl+O");
    end_panel();
    ImGui::PopStyleColor();
    return;
  }

  overlay_labels();
  const ViewRect legend_pane = legend(), key_pane = key();
  // The patient's sides at the edges of the view, beside other drawings.
  const Eigen::Matrix3d axes = picture_axes(input.camera);
  const Vector3d right = axes.row(0), up = axes.row(1);
  const float margin = pen.px(12);
  const float wiped_at = static_cast<float>(r.x + r.width * view.look.wipe_at);
  const auto letter = [&](const char* side, const Vector3d& direction, float ax, float ay) {
    const std::string words = direction_letters(direction);
    const ImVec2 size = theme.bold->CalcTextSizeA(theme.bold->FontSize, 1e6f, 0, words.c_str());
    float x = centre.x + ax * (static_cast<float>(r.width) / 2 - margin - size.x / 2) - size.x / 2;
    const auto overlaps = [&](const ViewRect& pane) {
      return pane.width > 0 && ay == 0 && pane.y < centre.y + size.y &&
             pane.y + pane.height > centre.y - size.y;
    };
    if (ax < 0 && overlaps(legend_pane))
      x = static_cast<float>(legend_pane.x + legend_pane.width) + margin;
    if (ax > 0 && overlaps(key_pane)) x = static_cast<float>(key_pane.x) - margin - size.x;
    // Beside the line between two states, which is drawn from top to bottom.
    const float beside = margin / 2;
    if (view.look.wipe && x - beside < wiped_at && wiped_at < x + size.x + beside)
      x = wiped_at + beside + size.x < r.x + r.width ? wiped_at + beside
                                                     : wiped_at - beside - size.x;
    const float y =
        centre.y + ay * (static_cast<float>(r.height) / 2 - margin - size.y / 2) - size.y / 2;
    pen.items.push_back({std::string("side:") + side, "view", {x, y, size.x, size.y}, words});
    // An edge keeps them readable over bone and skin.
    const float d = std::max(1.0f, pen.px(1));
    for (const auto& [dx, dy] : {std::pair{-d, 0.f}, {d, 0.f}, {0.f, -d}, {0.f, d}})
      list.AddText(theme.bold, theme.bold->FontSize, {x + dx, y + dy}, palette().letter_edge,
                   words.c_str());
    list.AddText(theme.bold, theme.bold->FontSize, {x, y}, palette().letter, words.c_str());
  };
  if (view.look.letters) {
    letter("right", right, 1, 0);
    letter("left", -right, -1, 0);
    letter("up", up, 0, -1);
    letter("down", -up, 0, 1);
  }
  if (view.look.scale_bar) scale();
  if (view.look.wipe) {
    const float top = static_cast<float>(r.y), bottom = top + static_cast<float>(r.height);
    list.AddLine({wiped_at, top}, {wiped_at, bottom}, palette().divider,
                 std::max(1.0f, pen.px(1.5f)));
    const float gap = pen.px(8), y = top + pen.px(34), high = theme.small->FontSize;
    const auto name = [&](const char* item, const char* words, bool before) {
      const float wide = text_width(theme.small, words);
      const float x = before ? wiped_at - gap - wide : wiped_at + gap;
      if (x < r.x || x + wide > r.x + r.width) return;  // pushed out of the picture
      list.AddText(theme.small, high, {std::round(x), y}, palette().divider, words);
      pen.items.push_back({item, "view", {x, y, wide, high}, words});
    };
    name("wipe:before", input.kept ? "kept" : input.scene.before ? "before" : "at rest", true);
    name("wipe:now", "now", false);
    pen.items.push_back({"wipe:line", "view", {wiped_at - 1.0, r.y, 2, r.height}});
  }
  cube();
  hover_text();
}

/// Progress of preparation: in the middle of an empty view, else above the picture.
void Panels::Drawing::progress() {
  if (input.progress.empty()) return;
  const Theme& theme = panels.theme_;
  const ViewRect& r = layout.view;
  const bool alone = input.scene.parts.empty();
  const float pad = pen.px(12), bar = pen.px(3), button = pen.px(72);
  const float room = static_cast<float>(r.width) - pen.px(80);
  const std::string words = fitted(theme.regular, input.progress, room - 2 * pad);
  const float wide = std::max(pen.px(280), text_width(theme.regular, words) + 2 * pad +
                                               (input.can_cancel ? button + pad : 0));
  const float high = pen.px(44);
  const float x = static_cast<float>(r.x + r.width / 2) - wide / 2;
  const float y =
      alone ? static_cast<float>(r.y + r.height / 2) - high : static_cast<float>(r.y) + pen.px(30);
  const auto place = [](float v) { return std::round(v); };
  begin_panel(pen, "progress", {place(x), place(y), place(wide), place(high)});
  ImGui::SetCursorPos({pad, pen.px(9)});
  text(theme.regular, palette().text, words);
  if (input.can_cancel) {
    ImGui::SetCursorPos({wide - pad - button, pen.px(6)});
    if (word_button(pen, "cancel", "Cancel", {button, pen.px(24)}, false))
      panels.requests_.emplace_back(request::Cancel{});
  }
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float left = place(x) + pad, full = wide - 2 * pad, top = place(y) + high - pen.px(9);
  const float done = static_cast<float>(std::clamp(input.progress_fraction, 0.0, 1.0));
  list.AddRectFilled({left, top}, {left + full, top + bar}, palette().track, bar);
  list.AddRectFilled({left, top}, {left + full * done, top + bar}, palette().accent, bar);
  end_panel();
}

/// A scale bar of a round length at the depth of the camera's target, at the bottom of the view.
void Panels::Drawing::scale() {
  const Theme& theme = panels.theme_;
  const ViewRect& r = layout.view;
  if (r.width < pen.px(400) || r.height < pen.px(160)) return;
  const ScaleBar bar =
      scale_bar(input.camera, static_cast<int>(r.height), static_cast<int>(r.width), 0.16);
  const auto wide = static_cast<float>(bar.pixels);
  const float right = static_cast<float>(r.x + r.width) - pen.px(120);
  const float y = static_cast<float>(r.y + r.height) - pen.px(16);
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ImU32 edge = palette().letter_edge, tint = palette().letter;
  for (const auto& [ink, thick] : {std::pair{edge, pen.px(4)}, {tint, pen.px(1.6f)}}) {
    list.AddLine({right - wide, y}, {right, y}, ink, thick);
    for (const float x : {right - wide, right})
      list.AddLine({x, y - pen.px(4)}, {x, y + pen.px(4)}, ink, thick);
  }
  const float words = text_width(theme.small, bar.text);
  const ImVec2 at = {std::round(right - wide / 2 - words / 2),
                     std::round(y - theme.small->FontSize - pen.px(5))};
  const float d = std::max(1.0f, pen.px(1));
  for (const auto& [dx, dy] : {std::pair{-d, 0.f}, {d, 0.f}, {0.f, -d}, {0.f, d}})
    list.AddText(theme.small, theme.small->FontSize, {at.x + dx, at.y + dy}, edge,
                 bar.text.c_str());
  list.AddText(theme.small, theme.small->FontSize, at, tint, bar.text.c_str());
}

void Panels::Drawing::cube() {
  const Theme& theme = panels.theme_;
  const double side = std::round(pen.px(92)), margin = std::round(pen.px(10));
  const ViewRect& r = layout.view;
  if (r.width < 3 * side || r.height < 3 * side) return;  // no space beside the patient
  const ViewRect place = {r.x + r.width - side - margin, r.y + r.height - side - margin, side,
                          side};
  ImGui::PushStyleColor(ImGuiCol_WindowBg, colour::rgb(0, 0));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2{0, 0});
  begin_panel(pen, "cube", place);
  ImGui::InvisibleButton("cube-area", {static_cast<float>(side), static_cast<float>(side)});
  const bool hovered = ImGui::IsItemHovered(), pressed = ImGui::IsItemActivated();
  const ImVec2 mouse = ImGui::GetIO().MousePos;

  const Eigen::Matrix3d axes = picture_axes(input.camera);
  const ImVec2 centre = {static_cast<float>(place.x + side / 2),
                         static_cast<float>(place.y + side / 2)};
  const float half = static_cast<float>(side) * 0.28f;
  const auto project = [&](const Vector3d& p) {
    const Vector3d q = axes * p;
    return ImVec2{centre.x + half * static_cast<float>(q.x()),
                  centre.y - half * static_cast<float>(q.y())};
  };
  ImDrawList& list = *ImGui::GetWindowDrawList();
  for (const Face& face : faces()) {
    const double facing = axes.row(2).dot(face.normal);
    if (facing < 0.02) continue;
    const Vector3d across = face.up.cross(face.normal);
    const std::array<ImVec2, 4> quad = {
        project(face.normal - across + face.up), project(face.normal + across + face.up),
        project(face.normal + across - face.up), project(face.normal - across - face.up)};
    const bool over = hovered && inside(quad, mouse);
    if (over && pressed) commands.push_back(face.command);
    const ImU32 fill =
        over ? palette().accent_dark : between(palette().cube_aslant, palette().cube_lit, facing);
    list.AddQuadFilled(quad[0], quad[1], quad[2], quad[3], fill);
    list.AddQuad(quad[0], quad[1], quad[2], quad[3], palette().cube_edge,
                 std::max(1.0f, pen.px(1)));

    if (facing < 0.2) continue;  // too slanted to read
    // The letter lies in the face: drawn flat at the centre, then its corners are moved there.
    ImFont* font = theme.large;
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, 1e6f, 0, face.letter);
    const ImVec2 flat = {centre.x - size.x / 2, centre.y - size.y / 2};
    const int first = list.VtxBuffer.Size;
    list.AddText(font, font->FontSize, flat, over ? palette().bright : palette().text, face.letter);
    const float unit = 1.2f / font->FontSize;  // letter height against the face's side of 2
    for (int i = first; i < list.VtxBuffer.Size; ++i) {
      ImVec2& p = list.VtxBuffer[i].pos;
      const double u = (p.x - centre.x) * unit, v = (p.y - centre.y) * unit;
      p = project(face.normal + u * across - v * face.up);
    }
  }
  end_panel();
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
}

}  // namespace condyle
