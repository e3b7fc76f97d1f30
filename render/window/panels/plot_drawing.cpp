#include "render/window/panels/plot_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sim/frame/covered_curves.h"
#include "sim/frame/label_placement.h"

namespace condyle {
namespace {

using Eigen::Vector2d;

// Okabe-Ito; for the light theme, yellow and sky blue are darker, to be visible on white.
constexpr std::array on_dark = {colour::rgb(0x56b4e9), colour::rgb(0xe69f00), colour::rgb(0x2fbf93),
                                colour::rgb(0xe8713a), colour::rgb(0xcc79a7), colour::rgb(0xf0e442),
                                colour::rgb(0xa0aab4), colour::rgb(0x8f9bff)};
constexpr std::array on_light = {
    colour::rgb(0x0072b2), colour::rgb(0xa86f00), colour::rgb(0x007a5a), colour::rgb(0xb8400a),
    colour::rgb(0xa0437a), colour::rgb(0x7a7200), colour::rgb(0x52606d), colour::rgb(0x4b52c8)};

ImU32 ink_of(const Curve& curve, std::size_t number, bool light) {
  const std::size_t n = curve.colour >= 0 ? static_cast<std::size_t>(curve.colour) : number;
  return light ? on_light[n % on_light.size()] : on_dark[n % on_dark.size()];
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double v) {
    if (!std::isfinite(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  double span() const { return high - low; }
  void grow_to(double min_span) {
    const double more = std::max(0.0, min_span - span()) / 2;
    low -= more;
    high += more;
  }
};

/// The rectangle of the curves on the screen, and its range.
struct Axes {
  Range x, y;
  float left, top, right, bottom;
  ImVec2 at(double px, double py) const {
    return {left + static_cast<float>((px - x.low) / x.span()) * (right - left),
            bottom - static_cast<float>((py - y.low) / y.span()) * (bottom - top)};
  }
};

void find_ranges(const PlotPanel& panel, Axes& axes) {
  const double y_most = panel.settings.y_most;
  for (const Curve& curve : panel.curves) {
    for (const double v : curve.x) axes.x.add(v);
    for (const double v : curve.y) axes.y.add(std::min(v, y_most));
  }
  for (const PlotBand& band : panel.settings.bands) {
    for (const double v : band.x) axes.x.add(v);
    for (const double v : band.y) axes.y.add(v);
  }
  for (const Level& level : panel.settings.levels) axes.y.add(level.y);
  for (Range* range : {&axes.x, &axes.y}) {
    if (!(range->low <= range->high)) *range = {0, 1};
    range->grow_to(1e-3);
  }
  axes.y.grow_to(1.08 * axes.y.span());
  if (!panel.settings.equal_scale) return;
  axes.x.grow_to(1.08 * axes.x.span());
  const double wide = axes.right - axes.left, high = axes.bottom - axes.top;
  const double per_pixel = std::max(axes.x.span() / wide, axes.y.span() / high);
  axes.x.grow_to(per_pixel * wide);
  axes.y.grow_to(per_pixel * high);
}

constexpr float tick_room = 36;  // for the numbers of the vertical axis, at scale 1

/// "0.5" and never "-0".
std::string number_text(double value, double step) {
  if (std::abs(value) < 1e-9 * step) value = 0;
  return fmt::format("{:g}", std::round(value / step * 1e6) / 1e6 * step);
}

std::string replaced(std::string words, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = words.find(what, at)) != std::string::npos; at += with.size())
    words.replace(at, what.size(), with);
  return words;
}

/// The label of an axis, "inferior  -  mm  -  superior", with abbreviated directions where it does
/// not fit.
std::string fitting_label(ImFont* font, std::string words, float room) {
  constexpr std::array<std::pair<const char*, const char*>, 5> shorter = {{{"  ", " "},
                                                                           {"inferior", "inf."},
                                                                           {"superior", "sup."},
                                                                           {"posterior", "post."},
                                                                           {"anterior", "ant."}}};
  for (const auto& [whole, few] : shorter)
    if (text_width(font, words) > room) words = replaced(words, whole, few);
  return fitted(font, words, room);
}

/// Text rotated upward from this position.
void draw_upward(ImDrawList& list, ImFont* font, ImVec2 from, ImU32 ink, const std::string& words) {
  const int first = list.VtxBuffer.Size;
  list.PushClipRectFullScreen();  // ImGui omits letters that would be clipped before the rotation
  list.AddText(font, font->FontSize, from, ink, words.c_str());
  list.PopClipRect();
  for (int i = first; i < list.VtxBuffer.Size; ++i) {
    ImVec2& p = list.VtxBuffer[i].pos;
    p = {from.x + (p.y - from.y), from.y - (p.x - from.x)};
  }
}

/// Reports the position of a plot's text.
void note(Pen& pen, const std::string& plot, const char* what, ImVec2 at,
          const std::string& words) {
  pen.items.push_back({fmt::format("{}:{}:{}", what, plot, words),
                       "plot:" + plot,
                       {at.x, at.y, text_width(pen.theme.small, words), pen.theme.small->FontSize},
                       words});
}

void draw_axes(Pen& pen, ImDrawList& list, const Axes& axes, const PlotSettings& settings) {
  const std::string& plot = settings.title;
  ImFont* font = pen.theme.small;
  const float hair = std::max(1.0f, pen.px(1));
  Ticks across_ticks =
      ticks(axes.x.low, axes.x.high, static_cast<int>((axes.right - axes.left) / pen.px(42)));
  if (settings.x_goes_back && across_ticks.step < 1) {
    across_ticks = {1, {}};
    for (double v = std::ceil(axes.x.low); v <= axes.x.high; ++v) across_ticks.values.push_back(v);
  }
  const Ticks up_ticks =
      ticks(axes.y.low, axes.y.high, static_cast<int>((axes.bottom - axes.top) / pen.px(24)));
  for (const double v : across_ticks.values) {
    const float x = axes.at(v, axes.y.low).x;
    list.AddLine({x, axes.top}, {x, axes.bottom}, palette().panel_edge, hair);
    const std::string words = number_text(settings.x_goes_back ? -v : v, across_ticks.step);
    const ImVec2 at = {std::round(x - text_width(font, words) / 2),
                       std::round(axes.bottom + pen.px(3))};
    list.AddText(font, font->FontSize, at, palette().text_dim, words.c_str());
    note(pen, plot, "x-tick", at, words);
  }
  for (const double v : up_ticks.values) {
    const float y = axes.at(axes.x.low, v).y;
    list.AddLine({axes.left, y}, {axes.right, y}, palette().panel_edge, hair);
    const std::string words = number_text(v, up_ticks.step);
    const ImVec2 at = {std::round(axes.left - text_width(font, words) - pen.px(5)),
                       std::round(y - font->FontSize / 2)};
    list.AddText(font, font->FontSize, at, palette().text_dim, words.c_str());
    note(pen, plot, "y-tick", at, words);
  }
  list.AddRect({axes.left, axes.top}, {axes.right, axes.bottom}, palette().outline, 0, 0, hair);
  const float high = axes.bottom - axes.top;
  const float left = axes.left - tick_room * pen.theme.scale - font->FontSize;
  const std::string across = fitting_label(font, settings.x_label, axes.right - left);
  const float wide = text_width(font, across);
  list.AddText(font, font->FontSize,
               {std::round(std::min((axes.left + axes.right - wide) / 2, axes.right - wide)),
                std::round(axes.bottom + font->FontSize + pen.px(4))},
               palette().text_dim, across.c_str());
  const std::string up = fitting_label(font, settings.y_label, high);
  draw_upward(list, font,
              {std::round(left), std::round((axes.top + axes.bottom + text_width(font, up)) / 2)},
              palette().text_dim, up);
}

/// Corners of a band's area, clockwise, as ImGui requires for antialiasing.
std::vector<ImVec2> corners_of(const PlotBand& band, const Axes& axes) {
  std::vector<ImVec2> corners;
  if (band.x.empty()) {
    const auto [low, high] = std::minmax_element(band.y.begin(), band.y.end());
    const ImVec2 a = axes.at(axes.x.low, *high), b = axes.at(axes.x.high, *low);
    return {a, {b.x, a.y}, b, {a.x, b.y}};
  }
  double area = 0;
  for (std::size_t i = 0; i < band.x.size(); ++i) corners.push_back(axes.at(band.x[i], band.y[i]));
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const ImVec2 &p = corners[i], &q = corners[(i + 1) % corners.size()];
    area += p.x * q.y - q.x * p.y;
  }
  if (area < 0) std::reverse(corners.begin(), corners.end());
  return corners;
}

void draw_bands(const Pen& pen, ImDrawList& list, const PlotPanel& panel, const Axes& axes) {
  const ImU32 fill = pen.theme.light ? colour::rgb(0x007a5a, 38) : colour::rgb(0x2fbf93, 48);
  for (const PlotBand& band : panel.settings.bands) {
    if (band.y.empty()) continue;
    const auto corners = corners_of(band, axes);
    list.AddConvexPolyFilled(corners.data(), static_cast<int>(corners.size()), fill);
  }
  for (const Level& level : panel.settings.levels)
    list.AddLine(axes.at(axes.x.low, level.y), axes.at(axes.x.high, level.y), palette().warning,
                 std::max(1.0f, pen.px(1)));
}

/// Names of bands and levels, beside the curves; a background keeps them readable where space is
/// lacking.
void draw_names(Pen& pen, ImDrawList& list, const PlotPanel& panel, const Axes& axes) {
  ImFont* font = pen.theme.small;
  const float pad = pen.px(2), high = font->FontSize + pad;
  LabelPlacement places({axes.left + pad, axes.top, axes.right - pad, axes.bottom}, pen.px(1));
  const auto point = [](const ImVec2& p) { return LabelPlacement::Point{p.x, p.y}; };
  const bool still = !panel.settings.x_goes_back;  // names do not jump as curves advance
  for (const Curve& curve : panel.curves) {
    std::vector<LabelPlacement::Point> run;
    for (std::size_t i = 0; still && i < std::min(curve.x.size(), curve.y.size()); ++i) {
      if (std::isfinite(curve.y[i]) && curve.y[i] <= panel.settings.y_most) {
        run.push_back(point(axes.at(curve.x[i], curve.y[i])));
        continue;
      }
      places.add_curve(run);
      run.clear();
    }
    places.add_curve(run);
  }
  for (const Level& level : panel.settings.levels)
    places.add_curve({point(axes.at(axes.x.low, level.y)), point(axes.at(axes.x.high, level.y))});
  for (const PlotBand& band : panel.settings.bands) {
    std::vector<LabelPlacement::Point> outline;
    for (const ImVec2& p : corners_of(band, axes)) outline.push_back(point(p));
    if (!band.x.empty()) places.add_outline(outline);
  }
  const auto write = [&](const std::string& words, const DrawnArea& near, ImU32 ink) {
    if (words.empty()) return;
    const float wide = text_width(font, words) + 2 * pad;
    const auto found = places.take(wide, high, near);
    const ImVec2 at = {std::round(static_cast<float>(found.x) + pad),
                       std::round(static_cast<float>(found.y))};
    list.AddRectFilled({at.x - pad, at.y}, {at.x + wide - pad, at.y + high},
                       (palette().well & ~IM_COL32_A_MASK) | (190u << IM_COL32_A_SHIFT));
    list.AddText(font, font->FontSize, at, ink, words.c_str());
    note(pen, panel.settings.title, "plot-word", at, words);
  };
  for (const PlotBand& band : panel.settings.bands) {
    if (band.y.empty()) continue;
    const auto corners = corners_of(band, axes);
    DrawnArea near{corners[0].x, corners[0].y, corners[0].x, corners[0].y};
    for (const ImVec2& p : corners)
      near = {std::min<double>(near.left, p.x), std::min<double>(near.top, p.y),
              std::max<double>(near.right, p.x), std::max<double>(near.bottom, p.y)};
    if (band.x.empty()) near.right = near.left;
    write(band.name, near, palette().good);
  }
  for (const Level& level : panel.settings.levels) {
    const ImVec2 at = axes.at(axes.x.low, level.y);
    write(level.name, {at.x, at.y - high, at.x, at.y}, palette().warning);
  }
}

void draw_curve(const Pen& pen, ImDrawList& list, const Curve& curve, const Axes& axes,
                double y_most, ImU32 ink, float width) {
  std::vector<ImVec2> run;
  const auto stroke = [&] {
    if (run.size() > 1) list.AddPolyline(run.data(), static_cast<int>(run.size()), ink, 0, width);
    run.clear();
  };
  const std::size_t count = std::min(curve.x.size(), curve.y.size());
  float gone = 0;  // along the curve, for its dashes
  ImVec2 last;
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(curve.y[i]) || curve.y[i] > y_most) {
      stroke();
      continue;
    }
    const ImVec2 p = axes.at(curve.x[i], curve.y[i]);
    if (i > 0) gone += std::hypot(p.x - last.x, p.y - last.y);
    last = p;
    run.push_back(p);
    if (curve.dashed && std::fmod(gone, pen.px(10)) > pen.px(6)) stroke();
  }
  stroke();
}

/// Legend in rows above the curves. Returns its height.
float draw_legend(const Pen& pen, ImDrawList* list, const PlotPanel& panel, float left, float right,
                  float top) {
  ImFont* font = pen.theme.small;
  const float line = font->FontSize + pen.px(2);
  float x = left, y = top;
  bool any = false;
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const Curve& curve = panel.curves[i];
    if (curve.name.empty() || !panel.settings.legend) continue;
    const float wide = pen.px(16) + text_width(font, curve.name) + pen.px(12);
    if (any && x + wide > right) {
      x = left;
      y += line;
    }
    any = true;
    if (list) {
      const ImU32 ink = ink_of(curve, i, pen.theme.light);
      const float middle = y + font->FontSize / 2;
      list->AddLine({x, middle}, {x + pen.px(12), middle}, ink, pen.px(2));
      list->AddText(font, font->FontSize, {std::round(x + pen.px(16)), std::round(y)},
                    palette().text_dim, curve.name.c_str());
    }
    x += wide;
  }
  return any ? y + line - top : 0;
}

}  // namespace

std::optional<Vector2d> place_on(const Curve& curve, const std::vector<double>& time_s,
                                 double now_s) {
  const std::size_t count = std::min(curve.x.size(), curve.y.size());
  if (count == 0 || count != time_s.size()) return std::nullopt;
  const auto after = std::lower_bound(time_s.begin(), time_s.end(), now_s);
  if (after == time_s.end() && now_s > time_s.back() + 0.1) return std::nullopt;
  const std::size_t b = std::min(static_cast<std::size_t>(after - time_s.begin()), count - 1);
  const std::size_t a = b > 0 ? b - 1 : 0;
  const double gap = time_s[b] - time_s[a];
  const double fraction = gap > 0 ? std::clamp((now_s - time_s[a]) / gap, 0.0, 1.0) : 0;
  return Vector2d(curve.x[a] + fraction * (curve.x[b] - curve.x[a]),
                  curve.y[a] + fraction * (curve.y[b] - curve.y[a]));
}

void draw_plot(Pen& pen, const PlotPanel& panel, const std::vector<double>& time_s, double now_s,
               const ViewRect& rect) {
  const Theme& theme = pen.theme;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float left = static_cast<float>(rect.x), top = static_cast<float>(rect.y);
  const float right = left + static_cast<float>(rect.width),
              bottom = top + static_cast<float>(rect.height);
  pen.items.push_back({"plot:" + panel.settings.title, pen.panel, rect});

  const float title_high = theme.regular->FontSize + pen.px(3);
  list.AddText(theme.regular, theme.regular->FontSize, {left, top}, palette().text,
               fitted(theme.regular, panel.settings.title, right - left).c_str());
  const float legend_top = top + title_high;
  const float legend_high = draw_legend(pen, nullptr, panel, left, right, legend_top);
  Axes axes{{},
            {},
            left + theme.small->FontSize + pen.px(tick_room),
            legend_top + legend_high + pen.px(3),
            right - pen.px(6),
            bottom - 2 * theme.small->FontSize - pen.px(8)};
  if (axes.right - axes.left < pen.px(40) || axes.bottom - axes.top < pen.px(30)) return;
  draw_legend(pen, &list, panel, left, right, legend_top);
  find_ranges(panel, axes);
  list.AddRectFilled({axes.left, axes.top}, {axes.right, axes.bottom}, palette().well);
  draw_axes(pen, list, axes, panel.settings);
  list.PushClipRect({axes.left, axes.top}, {axes.right, axes.bottom}, true);
  draw_bands(pen, list, panel, axes);
  std::vector<std::vector<LabelPlacement::Point>> runs(panel.curves.size());
  for (std::size_t i = 0; i < runs.size(); ++i)
    for (std::size_t k = 0; k < std::min(panel.curves[i].x.size(), panel.curves[i].y.size()); ++k) {
      const ImVec2 p = axes.at(panel.curves[i].x[k], panel.curves[i].y[k]);
      runs[i].push_back({p.x, p.y});
    }
  for (std::size_t i = 0; i < panel.curves.size(); ++i)
    draw_curve(pen, list, panel.curves[i], axes, panel.settings.y_most,
               ink_of(panel.curves[i], i, theme.light),
               pen.px(1.6f + 2.4f * static_cast<float>(curves_over(runs, i))));
  draw_names(pen, list, panel, axes);
  bool over_time = false;
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const Curve& curve = panel.curves[i];
    const auto place = place_on(curve, time_s, now_s);
    if (!place || !std::isfinite(place->y()) || place->y() > panel.settings.y_most) continue;
    over_time |= curve.x == time_s;
    const ImVec2 at = axes.at(place->x(), place->y());
    list.AddCircleFilled(at, pen.px(4.5f), palette().panel, 16);
    list.AddCircleFilled(at, pen.px(3.2f), ink_of(curve, i, theme.light), 16);
  }
  if (over_time && now_s >= axes.x.low && now_s <= axes.x.high) {
    const float x = axes.at(now_s, axes.y.low).x;
    list.AddLine({x, axes.top}, {x, axes.bottom}, palette().text_dim, std::max(1.0f, pen.px(1)));
  }
  list.PopClipRect();

  // The nearest point of a curve under the mouse, in numbers.
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  if (!ImGui::IsMouseHoveringRect({axes.left, axes.top}, {axes.right, axes.bottom})) return;
  float nearest = pen.px(14);
  std::string words;
  ImVec2 mark;
  for (std::size_t c = 0; c < panel.curves.size(); ++c) {
    const Curve& curve = panel.curves[c];
    for (std::size_t i = 0; i < std::min(curve.x.size(), curve.y.size()); ++i) {
      const ImVec2 p = axes.at(curve.x[i], curve.y[i]);
      const float away = std::hypot(p.x - mouse.x, p.y - mouse.y);
      if (!(away < nearest)) continue;
      nearest = away;
      mark = p;
      words =
          fmt::format("{}\n{:.2f}, {:.2f}", curve.name.empty() ? panel.settings.title : curve.name,
                      panel.settings.x_goes_back ? -curve.x[i] : curve.x[i], curve.y[i]);
      if (curve.x.size() == time_s.size() && curve.x != time_s)
        words += fmt::format("\nat {:.2f} s", time_s[i]);
    }
  }
  if (words.empty()) return;
  list.AddCircle(mark, pen.px(5), palette().text, 16, pen.px(1.5f));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, pen.px(8, 5));
  ImGui::BeginTooltip();
  text(theme.small, palette().text, words);
  ImGui::EndTooltip();
  ImGui::PopStyleVar();
}

}  // namespace condyle
