#include "sim/report/check_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "sim/report/plots.h"

namespace condyle {
namespace {

constexpr double least_opening_mm = 2;  // range below which opening tells nothing
constexpr double most_clearance_mm = 12;

/// Runs of frames in which the mouth opens or closes; neighbours share a frame.
struct Phase {
  std::size_t first = 0, last = 0;
  bool opening = true;
};

std::vector<Phase> phases(const std::vector<double>& opening_mm) {
  constexpr double turned_mm = 0.3;  // a way back shorter than this does not count
  std::vector<Phase> found;
  Phase now;
  std::size_t extreme = 0;
  for (std::size_t i = 1; i < opening_mm.size(); ++i) {
    const double onward = (opening_mm[i] - opening_mm[extreme]) * (now.opening ? 1 : -1);
    if (onward >= 0) extreme = i;
    if (onward < -turned_mm) {
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

const char* const style = R"(<style>
body { font: 15px/1.45 sans-serif; color: #222; background: #fff; max-width: 1080px; margin: 24px auto; padding: 0 16px; }
h1 { font-size: 24px; margin: 0 0 4px; } h2 { font-size: 18px; margin: 28px 0 8px; }
.verdict { border: 2px solid #222; border-radius: 6px; padding: 12px 16px; margin: 16px 0; font-size: 18px; }
.bad { border-color: #b2182b; } .good { border-color: #2166ac; }
.bad strong, td.bad { color: #b2182b; } .good strong { color: #2166ac; }
table { border-collapse: collapse; width: 100%; font-size: 14px; }
th, td { border-bottom: 1px solid #ccc; padding: 6px 8px; text-align: left; vertical-align: top; }
th { border-bottom: 2px solid #888; } td.bad { font-weight: bold; }
figure { margin: 16px 0; } img, svg { max-width: 100%; height: auto; } figcaption { color: #444; font-size: 14px; }
.small { color: #555; font-size: 13px; } li { margin: 2px 0; }
</style>
)";

class PageWriter {
 public:
  PageWriter(const ClearanceCheck& check, const CheckPage& page) : check_(check), page_(page) {}

  std::string write() {
    add("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width\">\n<title>Clearance check: "
        "{}</title>\n",
        escaped(page_.patient));
    html_ += style;
    html_ += "</head>\n<body>\n";
    add("<h1>Clearance check</h1>\n<p>Patient <strong>{}</strong>, motion <strong>{}</strong>: "
        "{:.1f} "
        "s, opening up to {:.1f} mm. Margin to keep: {:.2f} mm.</p>\n",
        escaped(page_.patient), escaped(page_.motion), check_.time_s.back(),
        *std::max_element(check_.opening_mm.begin(), check_.opening_mm.end()), page_.margin_mm);
    verdict();
    table();
    html_ += "<h2>Clearance during the motion</h2>\n<figure>\n" +
             clearance_svg(check_, page_.margin_mm) + "</figure>\n";
    pictures();
    coronoids();
    words();
    html_ +=
        "<p class=\"small\">For research and education, not for clinical "
        "use.</p>\n</body>\n</html>\n";
    return std::move(html_);
  }

 private:
  template <class... Args>
  void add(fmt::format_string<Args...> text, Args&&... args) {
    fmt::format_to(std::back_inserter(html_), text, std::forward<Args>(args)...);
  }

  std::string where(int frame) const {
    const auto f = static_cast<std::size_t>(frame);
    return fmt::format("{:.1f} mm, {:.1f}°", check_.opening_mm[f], check_.rotation_deg[f]);
  }

  void verdict() {
    int collide = 0, close = 0;
    const PairVerdict* worst = nullptr;
    for (const auto& pair : check_.pairs) {
      collide += pair.penetrates;
      close += !pair.penetrates && pair.violates_margin;
    }
    const auto shown = pairs_to_show(check_, 1);
    if (!shown.empty()) worst = &check_.pairs[shown.front()];
    add("<div class=\"verdict {}\">", check_.violated() ? "bad" : "good");
    if (check_.pairs.empty()) {
      html_ +=
          "<strong>Nothing to check:</strong> the case has no two bones of which one moves "
          "against the other.";
    } else if (!check_.violated()) {
      html_ +=
          "<strong>&#10003; No violation.</strong> Nothing comes nearer than the margin or "
          "overlaps more than at rest.";
    } else {
      add("<strong>&#10007; Violation.</strong> Of {} pairs, {} {} and {} {} nearer than the "
          "margin.",
          check_.pairs.size(), collide, collide == 1 ? "collides" : "collide", close,
          close == 1 ? "comes" : "come");
    }
    if (worst)
      add(" {}: {} and {}, {}.", check_.violated() ? "Worst" : "Closest", escaped(worst->a),
          escaped(worst->b), escaped(worst_caption(check_, *worst)));
    html_ += "</div>\n";
  }

  void table() {
    html_ +=
        "<h2>Pairs</h2>\n<table>\n<tr><th>Fixed and moving</th><th>Rule</th><th>At rest</th>"
        "<th>Nearest<br>(opening, rotation)</th><th>First contact<br>(opening, rotation)</th>"
        "<th>Deepest beyond rest<br>(opening, rotation)</th><th>In contact,<br>share of time</th>"
        "<th>Contact when worst</th><th>Verdict</th></tr>\n";
    for (const auto& pair : check_.pairs) {
      add("<tr><td>{}<br>{}</td><td>{}</td>", escaped(pair.a), escaped(pair.b),
          pair.teeth            ? "may touch"
          : page_.margin_mm > 0 ? "must keep the margin"
                                : "must not touch");
      if (pair.rest_depth_mm > 0)
        add("<td>overlap {:.2f} mm</td>", pair.rest_depth_mm);
      else
        add("<td>{:.2f} mm apart</td>", pair.rest_distance_mm);
      if (pair.touching_frames > 0)
        html_ += "<td>touching</td>";
      else
        add("<td>{:.2f} mm<br>({})</td>", pair.least_distance_mm, where(pair.least_frame));
      if (pair.first_touch < 0)
        html_ += "<td>none</td>";
      else if (pair.rest_distance_mm == 0 && pair.first_touch == 0)
        html_ += "<td>at rest</td>";
      else
        add("<td>{}</td>", where(pair.first_touch));
      if (pair.beyond_rest_mm > 0)
        add("<td>{:.2f} mm<br>({})</td>", pair.beyond_rest_mm, where(pair.deepest_frame));
      else
        html_ += "<td>none</td>";
      add("<td>{:.0f} %</td>", 100.0 * pair.touching_frames / check_.frames);
      const auto& detail = pair.detail;
      if (pair.worst.touching) {
        add("<td>{:.1f} mm², {} {}, {}{}", detail.area_mm2, detail.patches,
            detail.patches == 1 ? "patch" : "patches", detail.side,
            detail.side == "both" ? " sides" : "");
        if (detail.volume_known)
          add("<br>overlap {:.1f} ± {:.1f} mm³", detail.volume_mm3, detail.volume_error_mm3);
        else
          html_ += "<br>overlap volume unknown: open surface";
        if (!detail.region.empty()) add("<br>{}", escaped(detail.region));
        html_ += "</td>";
      } else {
        html_ += "<td>none</td>";
      }
      if (pair.penetrates)
        html_ += "<td class=\"bad\">&#10007; collides</td>";
      else if (pair.violates_margin)
        html_ += "<td class=\"bad\">&#10007; too near</td>";
      else
        html_ += "<td>&#10003; clear</td>";
      html_ += "</tr>\n";
    }
    html_ += "</table>\n";
  }

  void pictures() {
    bool any = false;
    for (std::size_t i = 0; i < check_.pairs.size() && i < page_.pictures.size(); ++i) {
      if (page_.pictures[i].empty()) continue;
      if (!any) html_ += "<h2>Where it is closest</h2>\n";
      any = true;
      const auto& pair = check_.pairs[i];
      add("<figure><img src=\"{}\" alt=\"{} and {} coloured by distance\"><figcaption><strong>{} "
          "and "
          "{}</strong>: {}.",
          escaped(page_.pictures[i]), escaped(pair.a), escaped(pair.b), escaped(pair.a),
          escaped(pair.b), escaped(worst_caption(check_, pair)));
      if (const auto words = open_surface_words(pair); !words.empty()) add(" {}", escaped(words));
      html_ += "</figcaption></figure>\n";
    }
    if (any)
      html_ +=
          "<p class=\"small\">Red: inside the other bone. White: within 0.1 mm of touching. Blue: "
          "apart, paler when nearer. Grey: more than 5 mm apart. The scale is the same in every "
          "picture.</p>\n";
  }

  void coronoids() {
    html_ += "<h2>Coronoid process to zygoma</h2>\n";
    if (!check_.coronoids.empty()) {
      html_ +=
          "<table>\n<tr><th>Side</th><th>At rest</th><th>At widest opening</th><th>Least "
          "(opening, rotation)</th></tr>\n";
      const auto widest = std::max_element(check_.opening_mm.begin(), check_.opening_mm.end()) -
                          check_.opening_mm.begin();
      for (const auto& side : check_.coronoids)
        add("<tr><td>{}</td><td>{:.2f} mm</td><td>{:.2f} mm</td><td>{:.2f} mm ({})</td></tr>\n",
            side.side, side.mm.front(), side.mm[static_cast<std::size_t>(widest)], side.least_mm(),
            where(side.least_frame));
      html_ +=
          "</table>\n<p class=\"small\">From the mandible within 8 mm of the coronoid tip to the "
          "cranial bone beside it.</p>\n";
    }
    if (!check_.coronoids_missing.empty())
      add("<p>Not available: {}.</p>\n", escaped(check_.coronoids_missing));
  }

  void words() {
    html_ +=
        "<h2>How to read this</h2>\n<ul class=\"small\">\n"
        "<li>Opening is the drop of the lower incisal point from rest; rotation is that of the "
        "mandible "
        "from rest.</li>\n"
        "<li>Overlap that is there at rest (models of teeth often overlap) is the baseline: only "
        "deeper contact counts.</li>\n"
        "<li>Contact area: surface inside the other bone or within 0.1 mm of it. Overlap volume "
        "with "
        "the uncertainty of its sampling.</li>\n"
        "<li>The motion is walked as it is wanted, without stopping at contacts.</li>\n";
    for (const auto& note : page_.notes) add("<li>{}</li>\n", escaped(note));
    html_ += "</ul>\n";
  }

  const ClearanceCheck& check_;
  const CheckPage& page_;
  std::string html_;
};

}  // namespace

std::string clearance_svg(const ClearanceCheck& check, double margin_mm) {
  const auto [low, high] = std::minmax_element(check.opening_mm.begin(), check.opening_mm.end());
  const bool opens = *high - *low >= least_opening_mm;
  const auto& x = opens ? check.opening_mm : check.time_s;
  const auto runs =
      opens ? phases(check.opening_mm) : std::vector<Phase>{{0, check.time_s.size() - 1, true}};
  std::vector<Curve> curves;
  bool any_closing = false, any_cut = false;
  for (std::size_t p = 0; p < check.pairs.size(); ++p) {
    const auto& pair = check.pairs[p];
    for (const auto& run : runs) {
      curves.push_back(part_of(x, pair.clearance_mm, run));
      curves.back().colour = static_cast<int>(p);
      if (&run == &runs.front()) curves.back().name = pair.a + " / " + pair.b;
      any_closing |= !run.opening;
    }
    for (const double mm : pair.clearance_mm) any_cut |= mm > most_clearance_mm;
  }
  PlotSettings settings{.title = opens ? "Clearance against opening" : "Clearance over time",
                        .x_label = opens ? "opening at the incisors, mm" : "time, s",
                        .y_label = "clearance, mm  (negative: overlap)",
                        .levels = {{"touching", 0}},
                        .legend_beside = true,
                        .y_most = most_clearance_mm};
  if (margin_mm > 0)
    settings.levels.push_back({fmt::format("margin {:.2f} mm", margin_mm), margin_mm});
  if (any_closing) settings.remarks = {"through: opening", "dashed: closing, where it differs"};
  if (any_cut)
    settings.remarks.push_back(fmt::format("cut off above {:.0f} mm", most_clearance_mm));
  return plot_svg(curves, settings);
}

std::string check_page(const ClearanceCheck& check, const CheckPage& page) {
  return PageWriter(check, page).write();
}

}  // namespace condyle
