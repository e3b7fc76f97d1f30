#include "sim/report/check_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "sim/frame/part_names.h"
#include "sim/report/page_parts.h"
#include "sim/report/plots.h"

namespace condyle {
namespace {

class PageWriter {
 public:
  /// Of a check whose parts are named as people read them.
  PageWriter(const ClearanceCheck& check, const CheckPage& page) : check_(check), page_(page) {
    for (auto& pair : check_.pairs) {
      pair.a = readable_name(pair.a);
      pair.b = readable_name(pair.b);
    }
  }

  std::string write() {
    html_ = page_head("Clearance check: " + page_.patient);
    verdict();
    add("<h1>Clearance check</h1>\n<p>Patient <strong>{}</strong>, motion <strong>{}</strong>: "
        "{:.1f} s in {} frames, opening up to {:.1f} mm. Margin asked for: {:.2f} mm.</p>\n",
        escaped(page_.patient), escaped(page_.motion), check_.time_s.back(), check_.frames(),
        check_.opening_mm[check_.widest_frame()], check_.margin_mm);
    sentences();
    pictures();
    if (!check_.pairs.empty())
      html_ += "<h2>Clearance during the motion</h2>\n<figure>\n" + clearance_svg(check_) +
               "</figure>\n";
    coronoids();
    if (!check_.teeth.empty())
      html_ += "<h2>Teeth</h2>\n<figure>\n" + teeth_svg(check_) + "</figure>\n";
    table();
    words();
    html_ += page_foot();
    return std::move(html_);
  }

 private:
  template <class... Args>
  void add(fmt::format_string<Args...> text, Args&&... args) {
    fmt::format_to(std::back_inserter(html_), text, std::forward<Args>(args)...);
  }

  static std::string at(const MotionTime& when) {
    return fmt::format("{} mm, {}°, frame {}", tenths(when.opening_mm), tenths(when.rotation_deg),
                       when.frame);
  }

  void verdict() {
    add("<div class=\"verdict {}\"><strong>{} {}</strong>", check_.violated() ? "bad" : "good",
        check_.violated() ? "&#10007;" : "&#10003;", escaped(summary_words(check_)));
    if (const auto shown = pairs_to_show(check_, 1); !shown.empty()) {
      const auto& worst = check_.pairs[shown.front()];
      add(" {}: {} and {}, {}.", check_.violated() ? "Worst" : "Closest", escaped(worst.a),
          escaped(worst.b), escaped(worst_caption(worst)));
    }
    html_ +=
        "<br><span class=\"small\">For research and education, not for clinical use.</span>"
        "</div>\n";
  }

  void sentences() {
    if (check_.pairs.empty()) return;
    constexpr std::size_t most = 12;
    html_ += "<h2>Pair by pair, worst first</h2>\n<ol class=\"worst\">\n";
    const auto order = worst_first(check_);
    for (std::size_t k = 0; k < std::min(most, order.size()); ++k) {
      const auto& pair = check_.pairs[order[k]];
      add("<li>{} <strong>{} and {}</strong> ({}): {}. ", pair.violated() ? "&#10007;" : "&#10003;",
          escaped(pair.a), escaped(pair.b), escaped(rule_words(pair)),
          escaped(verdict_words(pair)));
      add("{}: {}.", pair.beyond_rest_mm > 0 ? "Deepest" : "Closest", escaped(worst_caption(pair)));
      if (pair.push_out_mm) add(" {}", escaped(push_out_words(pair)));
      html_ += "</li>\n";
    }
    html_ += "</ol>\n";
    if (order.size() > most)
      add("<p>{} more pairs are in the table below.</p>\n", order.size() - most);
  }

  void table() {
    if (check_.pairs.empty()) return;
    html_ +=
        "<h2>All pairs in numbers</h2>\n<table>\n<tr><th>Pair</th><th>Rule</th><th>At rest</th>"
        "<th>Nearest<br>(opening, rotation)</th><th>First touch</th>"
        "<th>Deepest beyond rest</th><th>Touching,<br>share of frames</th>"
        "<th>Contact when worst</th><th>Verdict</th></tr>\n";
    for (const std::size_t i : worst_first(check_)) row(check_.pairs[i]);
    html_ += "</table>\n";
  }

  void row(const PairVerdict& pair) {
    add("<tr><td>{}<br>{}</td><td>{}</td>", escaped(pair.a), escaped(pair.b),
        escaped(rule_words(pair)));
    if (pair.rest_depth_mm > 0)
      add("<td>overlap {:.2f} mm</td>", pair.rest_depth_mm);
    else
      add("<td>{:.2f} mm apart</td>", pair.rest_distance_mm);
    if (pair.first_touch)
      html_ += "<td>touching</td>";
    else
      add("<td>{:.2f} mm<br>({})</td>", pair.least_distance_mm, at(pair.least_at));
    if (!pair.first_touch)
      html_ += "<td>none</td>";
    else if (pair.rest_distance_mm == 0 && pair.first_touch->frame == 0)
      html_ += "<td>at rest</td>";
    else
      add("<td>{:.2f} s<br>({})</td>", pair.first_touch->time_s, at(*pair.first_touch));
    if (pair.beyond_rest_mm > 0)
      add("<td>{:.2f} mm<br>({})</td>", pair.beyond_rest_mm, at(pair.deepest_at));
    else
      html_ += "<td>none</td>";
    add("<td>{:.0f} %{}</td>", 100.0 * pair.touching_frames / check_.frames(),
        pair.touches > 1 ? fmt::format(", {} times", pair.touches) : "");
    const auto& measure = pair.worst.measure;
    if (pair.worst.sample.contact.touching) {
      add("<td>{:.1f} mm², {} {}, {}{}", measure.area_mm2, measure.patches,
          measure.patches == 1 ? "patch" : "patches", measure.side,
          measure.side == "both" ? " sides" : "");
      if (measure.volume_known)
        add("<br>overlap {:.1f} ± {:.1f} mm³", measure.volume_mm3, measure.volume_error_mm3);
      else
        html_ += "<br>overlap volume unknown: open surface";
      add("<br>{}</td>", escaped(measure.region()));
    } else {
      add("<td>none; nearest {}, {}</td>", measure.side, escaped(measure.region()));
    }
    if (pair.violated())
      add("<td class=\"bad\">&#10007; {}</td>", pair.collides            ? "collides"
                                                : pair.too_near          ? "too near"
                                                : pair.rest_depth_mm > 0 ? "overlaps at rest"
                                                                         : "too near at rest");
    else
      html_ += "<td>&#10003; clear</td>";
    html_ += "</tr>\n";
  }

  void pictures() {
    std::size_t drawn = 0, worth = 0;
    for (const std::size_t i : pairs_to_show(check_, check_.pairs.size())) {
      ++worth;
      if (i >= page_.pictures.size() || page_.pictures[i].empty()) continue;
      if (drawn++ == 0) html_ += "<h2>Where it is closest</h2>\n";
      const auto& pair = check_.pairs[i];
      add("<figure><img src=\"{}\" alt=\"{} and {} coloured by distance\"><figcaption><strong>{} "
          "and {}</strong>: {}.",
          escaped(page_.pictures[i]), escaped(pair.a), escaped(pair.b), escaped(pair.a),
          escaped(pair.b), escaped(worst_caption(pair)));
      if (const auto words = open_surface_words(pair); !words.empty()) add(" {}", escaped(words));
      html_ += "</figcaption></figure>\n";
    }
    if (drawn == 0) return;
    html_ +=
        "<p class=\"small\">Red: inside the other bone. White: within 0.1 mm of touching. Blue: "
        "apart, paler the farther. Grey: farther apart than the scale of the picture reaches, 5 mm "
        "where bones come near.";
    if (drawn < worth) add(" The {} worst of {} pairs are drawn.", drawn, worth);
    html_ += "</p>\n";
  }

  void coronoids() {
    html_ += "<h2>Coronoid process to zygoma</h2>\n";
    if (!check_.coronoids.empty()) {
      html_ += "<figure>\n" + coronoid_svg(check_) + "</figure>\n";
      html_ +=
          "<table>\n<tr><th>Side</th><th>At rest</th><th>At widest opening</th><th>Least "
          "(opening, rotation)</th></tr>\n";
      for (const auto& side : check_.coronoids) {
        const auto f = static_cast<std::size_t>(side.least_frame());
        add("<tr><td>{}</td><td>{:.2f} mm</td><td>{:.2f} mm</td><td>{:.2f} mm ({:.1f} mm, "
            "{:.1f}°, frame {})</td></tr>\n",
            side.side, side.mm.front(), side.mm[check_.widest_frame()], side.least_mm(),
            check_.opening_mm[f], check_.rotation_deg[f], f);
      }
      html_ +=
          "</table>\n<p class=\"small\">From the mandible within 8 mm of the coronoid tip to the "
          "cranial bone beside it.";
      for (const auto& side : check_.coronoids)
        if (side.estimated)
          add(" The {} tip is estimated from the mandible's shape: the case does not name it.",
              side.side);
      html_ += "</p>\n";
    }
    if (!check_.coronoids_missing.empty())
      add("<p>Not available: {}.</p>\n", escaped(check_.coronoids_missing));
  }

  void words() {
    html_ +=
        "<h2>How to read this</h2>\n<ul class=\"small\">\n"
        "<li>Opening is the drop of the lower incisal point from rest; rotation is that of the "
        "mandible from rest. Left and right are the patient's.</li>\n"
        "<li>Margin: the clearance that two bones which must not touch have to keep. Gap: what "
        "two surfaces that glide on each other have to keep.</li>\n"
        "<li>Overlap that is there at rest (models of teeth often overlap) is the baseline: only "
        "deeper contact counts as a collision. What already breaks a rule at rest is told as "
        "that.</li>\n"
        "<li>Touching: the surfaces meet or overlap. Contact area, and what pictures mark as "
        "contact: surface inside the other bone or within 0.1 mm of it, which may be there before "
        "anything touches. Overlap volume "
        "with the uncertainty of its sampling; unknown where a surface is open, for it has no "
        "inside.</li>\n"
        "<li>The motion is walked as it is wanted, without stopping at contacts.</li>\n";
    add("<li>Between frames, too, nothing thicker than 0.1 mm is passed through unseen: where "
        "clearance and motion left it open, {} further moments were looked at. Distances above "
        "the margin are those of the frames.</li>\n",
        check_.looks_between);
    for (const auto& note : page_.notes) add("<li>{}</li>\n", escaped(note));
    html_ += "</ul>\n";
  }

  ClearanceCheck check_;
  const CheckPage& page_;
  std::string html_;
};

}  // namespace

std::string check_page(const ClearanceCheck& check, const CheckPage& page) {
  return PageWriter(check, page).write();
}

}  // namespace condyle
