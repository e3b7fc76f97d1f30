#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "sim/report/occlusion_report.h"
#include "sim/report/page_parts.h"
#include "sim/report/plots.h"

namespace condyle {
namespace {

/// Teeth in the order in which one looks at a patient: his right on the left.
std::vector<int> row_of(bool upper) {
  std::vector<int> row;
  for (int k = 8; k >= 1; --k) row.push_back((upper ? 10 : 40) + k);
  for (int k = 1; k <= 8; ++k) row.push_back((upper ? 20 : 30) + k);
  return row;
}

class OcclusionPage {
 public:
  explicit OcclusionPage(const OcclusionReport& report) : report_(report), bite_(report.bite) {}

  std::string write() {
    html_ = page_head("Settled bite: " + report_.patient);
    add("<h1>Settled bite</h1>\n<p>Patient <strong>{}</strong>, closed from {}, on paper {:g} mm "
        "thick with {:.0f} N.</p>\n",
        escaped(report_.patient), escaped(report_.start), report_.settings.paper_mm,
        report_.settings.closing_force_N);
    verdict();
    measures();
    picture();
    loads();
    contacts();
    words();
    html_ += page_foot();
    return std::move(html_);
  }

 private:
  template <class... Args>
  void add(fmt::format_string<Args...> text, Args&&... args) {
    fmt::format_to(std::back_inserter(html_), text, std::forward<Args>(args)...);
  }

  double right_share() const { return bite_.contacts.empty() ? 0 : 1 - bite_.left_share; }

  void verdict() {
    add("<div class=\"verdict {}\">", bite_.stable ? "good" : "bad");
    if (bite_.stable)
      html_ += "<strong>&#10003; Stable bite.</strong> ";
    else
      add("<strong>&#10007; No stable bite:</strong> {}. What was reached: ",
          escaped(bite_.unstable_because));
    add("{} {}; {:.0f} % of the load left, {:.0f} % right. ", bite_.contacts.size(),
        bite_.contacts.size() == 1 ? "contact" : "contacts", 100 * bite_.left_share,
        100 * right_share());
    if (bite_.overlap_mm > 0)
      add("The teeth overlap by at most {:.3f} mm.</div>\n", bite_.overlap_mm);
    else if (bite_.gap_mm > 0)
      add("The teeth do not overlap; the paper leaves {:.2f} mm where they are nearest.</div>\n",
          bite_.gap_mm);
    else
      html_ += "The teeth touch and do not overlap.</div>\n";
  }

  void row(const std::string& what, const std::string& rest, const std::string& bite) {
    add("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", what, rest, bite);
  }

  void measures() {
    const auto mm = [](double value) { return fmt::format("{:.1f} mm", value); };
    const auto jet = [&](double value) { return mm(value) + (value < 0 ? " (reverse)" : ""); };
    const auto bite = [&](double value) { return mm(value) + (value < 0 ? " (open)" : ""); };
    html_ +=
        "<h2>Measures</h2>\n<table>\n<tr><th></th><th>As the case is</th><th>In this "
        "bite</th></tr>\n";
    row("Overjet", jet(bite_.before.overjet_mm), jet(bite_.after.overjet_mm));
    row("Overbite", bite(bite_.before.overbite_mm), bite(bite_.after.overbite_mm));
    row("Lower teeth moved, at most", "", fmt::format("{:.2f} mm", bite_.moved_from_rest_mm));
    row("Mandible turned", "", fmt::format("{:.2f}°", bite_.rotation_deg));
    if (bite_.condyle_moved)
      for (const int side : {1, 0}) {
        const auto& way = (*bite_.condyle_moved)[static_cast<std::size_t>(side)];
        row(side ? "Right condyle moved" : "Left condyle moved", "",
            fmt::format("{:.2f} mm{}", way.norm(),
                        way.norm() < 0.05 ? "" : " (" + way_in_words(way) + ")"));
      }
    if (bite_.front_known)
      row("Load on incisors and canines", "", fmt::format("{:.0f} %", 100 * bite_.front_share));
    row("Borne by the joints, of the closing force", "",
        fmt::format("{:.0f} %", 100 * bite_.joint_share));
    html_ += "</table>\n";
  }

  void picture() {
    if (report_.picture.empty()) return;
    add("<h2>Both arches</h2>\n<figure><img src=\"{}\" alt=\"both arches coloured by the gap "
        "between "
        "them\"><figcaption>The arches opened like a book. Dark red: marked by the paper (gap "
        "below "
        "{:g} mm). Yellow to pale: close. Grey: farther apart than 1 mm. The ring is where the "
        "load is "
        "largest.</figcaption></figure>\n",
        escaped(report_.picture), report_.settings.paper_mm);
  }

  /// A bar for each tooth, upper ones upward, as one looks at the patient.
  void loads() {
    if (bite_.teeth.empty()) return;
    std::map<int, const ToothLoad*> teeth;
    double most = 0.05;
    for (const auto& tooth : bite_.teeth) {
      teeth[tooth.fdi] = &tooth;
      most = std::max(most, tooth.load_share);
    }
    constexpr double step = 60, bar = 36, left = 24, top = 48, high = 120, names = 52;
    add("<h2>Load by tooth</h2>\n<figure><svg viewBox=\"0 0 {:.0f} {:.0f}\" "
        "font-family=\"sans-serif\" font-size=\"13\" text-anchor=\"middle\" role=\"img\" "
        "aria-label=\"load by tooth\">\n",
        2 * left + 16 * step, 2 * top + 2 * high + names);
    add("<text x=\"{:.0f}\" y=\"16\" text-anchor=\"start\" fill=\"#555\">patient's right</text>"
        "<text x=\"{:.0f}\" y=\"16\" text-anchor=\"end\" fill=\"#555\">patient's left</text>\n",
        left, left + 16 * step);
    for (const bool upper : {true, false}) {
      const double base = top + high + (upper ? 0 : names);
      double x = left;
      for (const int fdi : row_of(upper)) {
        const auto found = teeth.find(fdi);
        if (found != teeth.end()) {
          const double share = found->second->load_share, height = share / most * high;
          add("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.0f}\" height=\"{:.1f}\" "
              "fill=\"#0072B2\"/>",
              x + (step - bar) / 2, upper ? base - height : base, bar, height);
          add("<text x=\"{:.1f}\" y=\"{:.1f}\" font-weight=\"bold\">{}</text>", x + step / 2,
              upper ? base + 17 : base - 7, fdi);
          if (found->second->contacts > 0)
            add("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"#555\">{:.0f} %</text>", x + step / 2,
                upper ? base - height - 5 : base + height + 15, 100 * share);
          html_ += "\n";
        }
        x += step;
      }
    }
    html_ +=
        "</svg><figcaption>Share of the load that each tooth bears; 0 % is marked but hardly "
        "loaded, no figure means no contact.</figcaption></figure>\n";
  }

  void contacts() {
    if (bite_.contacts.empty()) return;
    const bool named = !bite_.teeth.empty();
    add("<h2>Contacts</h2>\n<table>\n<tr>{}<th>Side</th><th>Behind the upper incisal "
        "edge</th><th>Marked area</th><th>Gap</th><th>Share of the load</th></tr>\n",
        named ? "<th>Upper</th><th>Lower</th>" : "");
    for (const auto& contact : bite_.contacts) {
      html_ += "<tr>";
      if (named)
        for (const int fdi : {contact.upper_fdi, contact.lower_fdi})
          add("<td>{}</td>", fdi ? std::to_string(fdi) : "");
      add("<td>{}, {:.1f} mm from the midline</td><td>{:.1f} mm</td><td>{:.2f} mm²</td><td>{:.2f} "
          "mm</td><td>{:.1f} %</td></tr>\n",
          contact.left ? "left" : "right", std::abs(contact.place.x() - bite_.midline_mm),
          contact.place.y() - bite_.upper_edge.y(), contact.area_mm2, contact.gap_mm,
          100 * contact.load_share);
    }
    html_ += "</table>\n";
  }

  void words() {
    add("<h2>How to read this</h2>\n<ul class=\"small\">\n"
        "<li>The mandible was opened until the teeth were apart and closed on an elastic paper, "
        "pushed up at the first molars of both sides; soft springs hold the condyles. It was "
        "closed "
        "{} times from places beside each other; the deepest rest is shown.{}</li>\n",
        bite_.starts, others());
    html_ +=
        "<li>A contact is where the gap is less than the paper is thick: what the paper would "
        "mark. Load is the force of the paper.</li>\n"
        "<li>Overjet and overbite are the horizontal and vertical way from the upper to the lower "
        "incisal edges, to the plane of the upper incisal edge and first molars.</li>\n"
        "<li>How far a condyle moves from its place in the case, which is seated if the case was "
        "taken in centric relation, is the shift into this bite: 0.9 ± 0.5 mm in healthy "
        "adults (Utz 2021).</li>\n"
        "<li>pose.csv holds the bite, motion.csv the way from the start to it by way of an open "
        "mouth; "
        "<code>condyle check CASE --motion pose.csv</code> looks at the bones in it.</li>\n";
    for (const auto* notes : {&bite_.notes, &report_.notes})
      for (const auto& note : *notes) add("<li>{}</li>\n", escaped(note));
    html_ += "</ul>\n";
  }

  std::string others() const {
    if (bite_.others.empty()) return " It always ended there.";
    return fmt::format(" It also came to rest in {} other {}, less deep.", bite_.others.size(),
                       bite_.others.size() == 1 ? "place" : "places");
  }

  const OcclusionReport& report_;
  const Bite& bite_;
  std::string html_;
};

}  // namespace

std::string OcclusionReport::page() const { return OcclusionPage(*this).write(); }

}  // namespace condyle
