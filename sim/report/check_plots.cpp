#include <fmt/format.h>

#include <algorithm>

#include "sim/frame/part_names.h"
#include "sim/report/check_page.h"
#include "sim/report/plots.h"

namespace condyle {
namespace {

constexpr double min_opening_mm = 2;  // smaller ranges of opening are plotted over time
constexpr double max_clearance_mm = 12;
constexpr std::size_t max_pairs = 8;

/// Runs of frames in which the mouth opens or closes; adjacent runs share a frame.
struct Phase {
  std::size_t first = 0, last = 0;
  bool opening = true;
};

std::vector<Phase> phases(const std::vector<double>& opening_mm) {
  constexpr double turned_mm = 0.3;  // shorter reversals are ignored
  std::vector<Phase> found;
  Phase now;
  std::size_t extreme = 0;
  for (std::size_t i = 1; i < opening_mm.size(); ++i) {
    const double advance = (opening_mm[i] - opening_mm[extreme]) * (now.opening ? 1 : -1);
    if (advance >= 0) extreme = i;
    if (advance < -turned_mm) {
      now.last = extreme;
      if (now.last > now.first) found.push_back(now);
      now = {extreme, i, !now.opening};
      extreme = i;
    }
  }
  now.last = opening_mm.size() - 1;
  found.push_back(now);
  return found;
}

Curve part_of(const std::vector<double>& x, const std::vector<double>& y, const Phase& phase) {
  const auto first = static_cast<std::ptrdiff_t>(phase.first),
             end = static_cast<std::ptrdiff_t>(phase.last) + 1;
  return {.name = "",
          .x = {x.begin() + first, x.begin() + end},
          .y = {y.begin() + first, y.begin() + end},
          .colour = -1,
          .dashed = !phase.opening};
}

/// Clearances against opening, or against time where the mouth hardly opens.
struct ClearanceCurve {
  std::string name;
  const std::vector<double>* mm;
};

std::string clearance_plot(const ClearanceCheck& check, const std::string& title,
                           const std::vector<ClearanceCurve>& shown, std::vector<Level> levels,
                           const std::string& remark) {
  const auto [low, high] = std::minmax_element(check.opening_mm.begin(), check.opening_mm.end());
  const bool opens = *high - *low >= min_opening_mm;
  const auto& x = opens ? check.opening_mm : check.time_s;
  const auto runs =
      opens ? phases(check.opening_mm) : std::vector<Phase>{{0, check.time_s.size() - 1, true}};
  std::vector<Curve> curves;
  bool any_closing = false, any_cut = false;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    for (const auto& run : runs) {
      curves.push_back(part_of(x, *shown[i].mm, run));
      curves.back().colour = static_cast<int>(i);
      if (&run == &runs.front()) curves.back().name = shown[i].name;
      any_closing |= !run.opening;
    }
    for (const double mm : *shown[i].mm) any_cut |= mm > max_clearance_mm;
  }
  PlotSettings settings{.title = title + (opens ? " against opening" : " over time"),
                        .x_label = opens ? "opening at the incisors, mm" : "time, s",
                        .y_label = "clearance, mm  (negative: overlap)",
                        .levels = std::move(levels),
                        .legend_beside = true,
                        .y_most = max_clearance_mm};
  settings.levels.push_back({"touching", 0});
  if (any_closing) settings.remarks = {"solid: opening", "dashed: closing, where it differs"};
  if (any_cut) settings.remarks.push_back(fmt::format("clipped above {:.0f} mm", max_clearance_mm));
  if (!remark.empty()) settings.remarks.push_back(remark);
  return plot_svg(curves, settings);
}

/// Columns of the chart of teeth, from the patient's right to left, in frontal view.
constexpr int half_arch = 8;

std::string fraction_colour(double fraction) {
  // White to the blue of the plots: readable in greyscale.
  const auto mix = [&](int from, int to) {
    return static_cast<int>(from + fraction * (to - from));
  };
  return fmt::format("#{:02x}{:02x}{:02x}", mix(255, 0x00), mix(255, 0x72), mix(255, 0xb2));
}

}  // namespace

std::string clearance_svg(const ClearanceCheck& check) {
  std::vector<ClearanceCurve> shown;
  std::vector<Level> levels;
  for (const std::size_t i : worst_first(check)) {
    const auto& pair = check.pairs[i];
    if (shown.size() == max_pairs) break;
    shown.push_back({display_name(pair.a) + " / " + readable_name(pair.b), &pair.clearance_mm});
    const bool drawn = std::any_of(levels.begin(), levels.end(),
                                   [&](const Level& level) { return level.y == pair.required_mm; });
    if (pair.required_mm <= 0 || drawn) continue;
    levels.push_back(
        {fmt::format("{} {:.2f} mm", pair.rule.policy == PairPolicy::guided ? "gap" : "margin",
                     pair.required_mm),
         pair.required_mm});
  }
  const std::size_t left_out = check.pairs.size() - shown.size();
  return clearance_plot(
      check, "Clearance", shown, std::move(levels),
      left_out > 0 ? fmt::format("{} more pairs are in pairs.csv", left_out) : "");
}

std::string coronoid_svg(const ClearanceCheck& check) {
  std::vector<ClearanceCurve> shown;
  for (const auto& side : check.coronoids)
    shown.push_back({display_name(side.side + " coronoid"), &side.mm});
  return shown.empty() ? "" : clearance_plot(check, "Coronoid to zygoma", shown, {}, "");
}

std::string teeth_svg(const ClearanceCheck& check) {
  if (check.teeth.empty()) return "";
  constexpr int cell = 44, left = 12, top = 40, gap = 10;
  constexpr int width = 2 * left + 2 * half_arch * cell + gap, height = top + 2 * cell + gap + 34;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" font-family=\"sans-serif\" font-size=\"13\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n"
      "<text x=\"{2}\" y=\"24\" font-size=\"16\" fill=\"#222\">Tooth contact, % of the "
      "motion's frames</text>\n",
      width, height, left);
  for (const auto& tooth : check.teeth) {
    // Quadrants 1 to 4; 5 to 8 are those of milk teeth.
    const int quadrant = (tooth.fdi / 10 - 1) % 4, number = tooth.fdi % 10;
    const bool upper = quadrant < 2, patients_left = quadrant == 1 || quadrant == 2;
    const int column = patients_left ? half_arch + number - 1 : half_arch - number;
    const int x = left + column * cell + (patients_left ? gap : 0);
    const int y = top + (upper ? 0 : cell + gap);
    const double fraction = static_cast<double>(tooth.touching_frames) / check.frames();
    svg += fmt::format(
        "<rect x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{2}\" fill=\"{3}\" stroke=\"#888\"/>"
        "<text x=\"{4}\" y=\"{5}\" text-anchor=\"middle\" fill=\"{6}\" "
        "font-weight=\"bold\">{7}</text>"
        "<text x=\"{4}\" y=\"{8}\" text-anchor=\"middle\" fill=\"{6}\" "
        "font-size=\"11\">{9:.0f} %</text>\n",
        x, y, cell, fraction_colour(fraction), x + cell / 2, y + 19,
        fraction > 0.55 ? "#fff" : "#222", tooth.fdi, y + 35, 100 * fraction);
  }
  const int below = top + 2 * cell + gap + 22;
  svg += fmt::format(
      "<text x=\"{}\" y=\"{}\" fill=\"#444\" font-size=\"12\">patient's right</text>"
      "<text x=\"{}\" y=\"{}\" fill=\"#444\" font-size=\"12\" text-anchor=\"end\">patient's "
      "left</text>\n</svg>\n",
      left, below, width - left, below);
  return svg;
}

}  // namespace condyle
