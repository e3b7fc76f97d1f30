#include "sim/report/check_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/html_text.h"
#include "sim/frame/part_names.h"
#include "sim/report/page_parts.h"
#include "sim/report/plots.h"

namespace condyle {
namespace {

class ClearancePage {
 public:
  /// Replaces the part names of the check by readable ones.
  ClearancePage(const ClearanceCheck& check, const CheckPage& page)
      : check_(check), page_(page), html_("Clearance check: " + page.patient) {
    for (auto& pair : check_.pairs) {
      pair.a = readable_name(pair.a);
      pair.b = readable_name(pair.b);
    }
  }

  std::string write() {
    verdict();
    html_.add(
        "<h1>Clearance check</h1>\n<p>Patient <strong>{}</strong>, motion <strong>{}</strong>: "
        "{:.1f} s in {} frames, maximum opening {:.1f} mm. Required margin: {:.2f} mm.</p>\n",
        escaped(page_.patient), escaped(page_.motion), check_.time_s.back(), check_.frames(),
        check_.opening_mm[check_.widest_frame()], check_.margin_mm);
    provenance();
    sentences();
    pictures();
    if (!check_.pairs.empty())
      html_ += "<h2>Clearance during the motion</h2>\n<figure>\n" + clearance_svg(check_) +
               "</figure>\n";
    coronoids();
    if (!check_.teeth.empty())
      html_ += "<h2>Teeth</h2>\n<figure>\n" + teeth_svg(check_) + "</figure>\n";
    table();
    if (page_.comparison) html_ += page_.comparison->html();
    explanations();
    return html_.finish();
  }

 private:
  static std::string at(const MotionTime& when) {
    return fmt::format("{} mm, {}°, frame {}", tenths(when.opening_mm), tenths(when.rotation_deg),
                       when.frame);
  }

  void verdict() {
    html_.add("<div class=\"verdict {}\"><strong>{} {}</strong>",
              check_.violated() ? "bad" : "good", check_.violated() ? "&#10007;" : "&#10003;",
              escaped(summary_text(check_)));
    if (const auto shown = pairs_to_show(check_, 1); !shown.empty()) {
      const auto& worst = check_.pairs[shown.front()];
      html_.add(" {}: {} and {}.", check_.violated() ? "Worst" : "Closest", escaped(worst.a),
                escaped(worst.b));
    }
    html_ +=
        "<br><span class=\"small\">For research and education, not for clinical use.</span>"
        "</div>\n";
  }

  /// Program, date and surfaces.
  void provenance() {
    if (page_.program.empty()) return;
    html_.add("<p class=\"small\">Made by {} on {}.", escaped(page_.program), escaped(page_.date));
    if (!page_.surfaces.empty()) html_ += " Surfaces, by the hash of their triangles:";
    for (const auto& surface : page_.surfaces)
      html_.add("{} {}", &surface == &page_.surfaces.front() ? "" : ",", escaped(surface));
    html_ += page_.surfaces.empty() ? "</p>\n" : ".</p>\n";
  }

  void sentences() {
    if (check_.pairs.empty()) return;
    constexpr std::size_t max_sentences = 12;
    html_.add("<h2>Pairs, {} first</h2>\n<ol class=\"worst\">\n",
              check_.violated() ? "worst" : "closest");
    const auto order = worst_first(check_);
    for (std::size_t k = 0; k < std::min(max_sentences, order.size()); ++k) {
      const auto& pair = check_.pairs[order[k]];
      html_.add(
          "<li>{} <strong>{} and {}</strong> ({}): ", pair.violated() ? "&#10007;" : "&#10003;",
          escaped(pair.a), escaped(pair.b), escaped(rule_text(pair)));
      if (pair.stays_apart())
        html_.add("stay at least {:.2f} mm apart, closest at {}: {}.", pair.min_distance_mm,
                  escaped(worst_moment(pair)), escaped(worst_place(pair)));
      else
        html_.add("{}. {}: {}.", escaped(verdict_text(pair)),
                  pair.beyond_rest_mm > 0 ? "Deepest" : "Closest", escaped(worst_caption(pair)));
      if (pair.push_out_mm) html_.add(" {}", escaped(push_out_text(pair)));
      html_ += "</li>\n";
    }
    html_ += "</ol>\n";
    if (order.size() > max_sentences)
      html_.add("<p>{} more pairs are listed in the table below.</p>\n",
                order.size() - max_sentences);
  }

  void table() {
    if (check_.pairs.empty()) return;
    html_ +=
        "<h2>All pairs</h2>\n<table>\n<tr><th>Pair</th><th>Rule</th><th>At rest</th>"
        "<th>Least distance<br>(opening, rotation)</th><th>First contact</th>"
        "<th>Depth beyond rest</th><th>In contact,<br>% of frames</th>"
        "<th>Contact at the worst moment</th><th>Verdict</th></tr>\n";
    for (const std::size_t i : worst_first(check_)) row(check_.pairs[i]);
    html_ += "</table>\n";
  }

  void row(const PairVerdict& pair) {
    html_.add("<tr><td>{}<br>{}</td><td>{}</td>", escaped(pair.a), escaped(pair.b),
              escaped(rule_text(pair)));
    if (pair.rest_depth_mm > 0)
      html_.add("<td>overlap {:.2f} mm</td>", pair.rest_depth_mm);
    else
      html_.add("<td>{:.2f} mm apart</td>", pair.rest_distance_mm);
    if (pair.first_touch)
      html_ += "<td>touching</td>";
    else
      html_.add("<td>{:.2f} mm<br>({})</td>", pair.min_distance_mm, at(pair.min_distance_at));
    if (!pair.first_touch)
      html_ += "<td>none</td>";
    else if (pair.rest_distance_mm == 0 && pair.first_touch->frame == 0)
      html_ += "<td>at rest</td>";
    else
      html_.add("<td>{:.2f} s<br>({})</td>", pair.first_touch->time_s, at(*pair.first_touch));
    if (pair.beyond_rest_mm > 0)
      html_.add("<td>{:.2f} mm<br>({})</td>", pair.beyond_rest_mm, at(pair.deepest_at));
    else
      html_ += "<td>none</td>";
    html_.add("<td>{:.0f} %{}</td>", 100.0 * pair.touching_frames / check_.frames(),
              pair.touches > 1 ? fmt::format(", {} times", pair.touches) : "");
    const auto& measure = pair.worst.measure;
    if (pair.worst.sample.contact.touching) {
      html_.add("<td>{:.1f} mm², {} {}, {}{}", measure.area_mm2, measure.patches,
                measure.patches == 1 ? "patch" : "patches", measure.side,
                measure.side == "both" ? " sides" : "");
      if (measure.volume_known)
        html_.add("<br>overlap {:.1f} ± {:.1f} mm³", measure.volume_mm3, measure.volume_error_mm3);
      else
        html_ += "<br>overlap volume unknown: open surface";
      html_.add("<br>{}</td>", escaped(measure.region()));
    } else {
      html_.add("<td>none; closest at {}, {}</td>", measure.side, escaped(measure.region()));
    }
    if (pair.violated())
      html_.add("<td class=\"bad\">&#10007; {}</td>", pair.collides    ? "collides"
                                                      : pair.too_close ? "too close"
                                                      : pair.rest_depth_mm > 0
                                                          ? "overlaps at rest"
                                                          : "too close at rest");
    else
      html_ += "<td>&#10003; clear</td>";
    html_ += "</tr>\n";
  }

  void pictures() {
    std::size_t drawn = 0, candidates = 0;
    for (const std::size_t i : pairs_to_show(check_, check_.pairs.size())) {
      ++candidates;
      if (i >= page_.pictures.size() || page_.pictures[i].empty()) continue;
      if (drawn++ == 0) html_ += "<h2>Where it is closest</h2>\n";
      const auto& pair = check_.pairs[i];
      html_.add("<figure><img src=\"{}\" alt=\"{} and {} coloured by distance\">",
                escaped(page_.pictures[i]), escaped(pair.a), escaped(pair.b));
      if (const auto words = open_surface_text(pair); !words.empty())
        html_.add("<figcaption>{}</figcaption>", escaped(words));
      html_ += "</figure>\n";
    }
    if (drawn == 0) return;
    html_ +=
        "<p class=\"small\">Red: inside the other bone. White: within 0.1 mm of touching. Blue: "
        "apart, paler with distance. Grey: beyond the range of the colour scale, which is 5 mm for "
        "bones that come close.";
    if (drawn < candidates) html_.add(" The {} worst of {} pairs are shown.", drawn, candidates);
    html_ += "</p>\n";
  }

  void coronoids() {
    html_ += "<h2>Coronoid process to zygoma</h2>\n";
    if (!check_.coronoids.empty()) {
      html_ += "<figure>\n" + coronoid_svg(check_) + "</figure>\n";
      html_ +=
          "<table>\n<tr><th>Side</th><th>At rest</th><th>At widest opening</th><th>Minimum "
          "(opening, rotation)</th></tr>\n";
      for (const auto& side : check_.coronoids) {
        const auto f = static_cast<std::size_t>(side.min_frame());
        html_.add(
            "<tr><td>{}</td><td>{:.2f} mm</td><td>{:.2f} mm</td><td>{:.2f} mm ({:.1f} mm, "
            "{:.1f}°, frame {})</td></tr>\n",
            side.side, side.mm.front(), side.mm[check_.widest_frame()], side.min_mm(),
            check_.opening_mm[f], check_.rotation_deg[f], f);
      }
      html_ +=
          "</table>\n<p class=\"small\">Distance from the mandible within 8 mm of the coronoid tip "
          "to "
          "the adjacent cranial bone.";
      for (const auto& side : check_.coronoids)
        if (side.estimated)
          html_.add(
              " The case has no landmark for the {} tip; it is estimated from the shape of the "
              "mandible.",
              side.side);
      html_ += "</p>\n";
    }
    if (!check_.coronoids_missing.empty())
      html_.add("<p>Not available: {}.</p>\n", escaped(check_.coronoids_missing));
  }

  void explanations() {
    html_ +=
        "<h2>How to read this</h2>\n<ul class=\"small\">\n"
        "<li>Opening is the downward displacement of the lower incisal point from rest, rotation "
        "that of the mandible. Left and right are the patient's.</li>\n"
        "<li>Margin: the clearance required between two bones that must not touch. Gap: the "
        "clearance required between two surfaces that glide on each other.</li>\n"
        "<li>Overlap at rest (models of teeth often overlap) is the baseline: only deeper contact "
        "counts as a collision. A rule that is broken at rest is reported separately.</li>\n"
        "<li>In contact: the surfaces meet or overlap. Contact area, in the table and in the "
        "pictures, is the surface inside the other bone or within 0.1 mm of it; it can be present "
        "before the surfaces touch. Overlap volume is given with its sampling uncertainty; it is "
        "unknown where a surface is open, because an open surface has no inside.</li>\n"
        "<li>The prescribed motion is evaluated without stopping at contacts.</li>\n";
    html_.add(
        "<li>Contacts between frames are found as well, down to an overlap of 0.1 mm; the least "
        "distance of each pair is refined to 0.01 mm, whatever the margin and the frames. {} "
        "additional samples were taken for this.</li>\n",
        check_.samples_between);
    html_.add_notes(page_.notes);
    html_ += "</ul>\n";
  }

  ClearanceCheck check_;
  const CheckPage& page_;
  PageWriter html_;
};

}  // namespace

std::string check_page(const ClearanceCheck& check, const CheckPage& page) {
  return ClearancePage(check, page).write();
}

}  // namespace condyle
