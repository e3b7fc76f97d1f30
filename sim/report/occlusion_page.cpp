#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/core/html_text.h"
#include "sim/report/occlusion_report.h"
#include "sim/report/page_parts.h"
#include "sim/report/plots.h"

namespace condyle {
namespace {

/// FDI numbers in frontal view: the patient's right on the left.
std::vector<int> row_of(bool upper) {
  std::vector<int> row;
  for (int k = 8; k >= 1; --k) row.push_back((upper ? 10 : 40) + k);
  for (int k = 1; k <= 8; ++k) row.push_back((upper ? 20 : 30) + k);
  return row;
}

class OcclusionPage {
 public:
  explicit OcclusionPage(const OcclusionReport& report)
      : report_(report), bite_(report.bite), html_("Maximum intercuspation: " + report.patient) {}

  std::string write() {
    html_.add(
        "<h1>Maximum intercuspation</h1>\n<p>Patient <strong>{}</strong>, closed from {} on "
        "articulating film {:g} mm thick with {:.0f} N.</p>\n",
        escaped(report_.patient), escaped(report_.start), report_.settings.film_mm,
        report_.settings.closing_force_N);
    verdict();
    measures();
    picture();
    loads();
    contacts();
    explanations();
    return html_.finish();
  }

 private:
  double right_fraction() const { return bite_.contacts.empty() ? 0 : 1 - bite_.left_fraction; }

  void verdict() {
    html_.add("<div class=\"verdict {}\">", bite_.stable ? "good" : "bad");
    if (bite_.stable)
      html_ += "<strong>&#10003; Stable bite.</strong> ";
    else
      html_.add("<strong>&#10007; No stable bite:</strong> {}. Pose reached: ",
                escaped(bite_.unstable_because));
    html_.add("{} {}; {:.0f} % of the load left, {:.0f} % right. ", bite_.contacts.size(),
              bite_.contacts.size() == 1 ? "contact" : "contacts", 100 * bite_.left_fraction,
              100 * right_fraction());
    if (bite_.overlap_mm > 0)
      html_.add("The teeth overlap by at most {:.3f} mm.</div>\n", bite_.overlap_mm);
    else if (bite_.gap_mm > 0)
      html_.add(
          "The teeth do not overlap; the least gap, filled by the film, is {:.2f} mm.</div>\n",
          bite_.gap_mm);
    else
      html_ += "The teeth touch and do not overlap.</div>\n";
  }

  void row(const std::string& what, const std::string& rest, const std::string& bite) {
    html_.add("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", what, rest, bite);
  }

  void measures() {
    const auto mm = [](double value) { return fmt::format("{:.1f} mm", value); };
    const auto jet = [&](double value) { return mm(value) + (value < 0 ? " (reverse)" : ""); };
    const auto bite = [&](double value) { return mm(value) + (value < 0 ? " (open)" : ""); };
    html_ +=
        "<h2>Measures</h2>\n<table>\n<tr><th></th><th>At rest</th><th>In this bite</th></tr>\n";
    row("Overjet", jet(bite_.before.overjet_mm), jet(bite_.after.overjet_mm));
    row("Overbite", bite(bite_.before.overbite_mm), bite(bite_.after.overbite_mm));
    row("Largest displacement of the lower teeth", "",
        fmt::format("{:.2f} mm", bite_.moved_from_rest_mm));
    row("Rotation of the mandible", "", fmt::format("{:.2f}°", bite_.rotation_deg));
    if (bite_.condyle_moved)
      for (const int side : {1, 0}) {
        const auto& d = (*bite_.condyle_moved)[static_cast<std::size_t>(side)];
        row(side ? "Displacement of the right condyle" : "Displacement of the left condyle", "",
            fmt::format("{:.2f} mm{}", d.norm(),
                        d.norm() < 0.05 ? "" : " (" + displacement_text(d) + ")"));
      }
    if (bite_.front_known)
      row("Load on incisors and canines", "", fmt::format("{:.0f} %", 100 * bite_.front_fraction));
    row("Joint load, of the closing force", "",
        fmt::format("{:.0f} %", 100 * bite_.joint_fraction));
    html_ += "</table>\n";
  }

  void picture() {
    if (report_.picture.empty()) return;
    html_.add(
        "<h2>Both arches</h2>\n<figure><img src=\"{}\" alt=\"both arches coloured by the gap "
        "between "
        "them\"><figcaption>The arches opened like a book. Dark red: marked by the film (gap below "
        "{:g} mm). "
        "Yellow to pale: close. Grey: more than 1 mm apart. The ring marks the largest "
        "load.</figcaption></figure>\n",
        escaped(report_.picture), report_.settings.film_mm);
  }

  /// One bar per tooth in frontal view, upper teeth upward.
  void loads() {
    if (bite_.teeth.empty()) return;
    std::map<int, const ToothLoad*> teeth;
    double max_fraction = 0.05;
    for (const auto& tooth : bite_.teeth) {
      teeth[tooth.fdi] = &tooth;
      max_fraction = std::max(max_fraction, tooth.load_fraction);
    }
    constexpr double step = 60, bar = 36, left = 24, top = 48, high = 120, names = 52;
    html_.add(
        "<h2>Load by tooth</h2>\n<figure><svg viewBox=\"0 0 {:.0f} {:.0f}\" "
        "font-family=\"sans-serif\" font-size=\"13\" text-anchor=\"middle\" role=\"img\" "
        "aria-label=\"load by tooth\">\n",
        2 * left + 16 * step, 2 * top + 2 * high + names);
    html_.add(
        "<text x=\"{:.0f}\" y=\"16\" text-anchor=\"start\" fill=\"#555\">patient's right</text>"
        "<text x=\"{:.0f}\" y=\"16\" text-anchor=\"end\" fill=\"#555\">patient's left</text>\n",
        left, left + 16 * step);
    for (const bool upper : {true, false}) {
      const double base = top + high + (upper ? 0 : names);
      double x = left;
      for (const int fdi : row_of(upper)) {
        const auto found = teeth.find(fdi);
        if (found != teeth.end()) {
          const double fraction = found->second->load_fraction,
                       height = fraction / max_fraction * high;
          html_.add(
              "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.0f}\" height=\"{:.1f}\" "
              "fill=\"#0072B2\"/>",
              x + (step - bar) / 2, upper ? base - height : base, bar, height);
          html_.add("<text x=\"{:.1f}\" y=\"{:.1f}\" font-weight=\"bold\">{}</text>", x + step / 2,
                    upper ? base + 17 : base - 7, fdi);
          if (found->second->contacts > 0)
            html_.add("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"#555\">{:.0f} %</text>", x + step / 2,
                      upper ? base - height - 5 : base + height + 15, 100 * fraction);
          html_ += "\n";
        }
        x += step;
      }
    }
    html_ +=
        "</svg><figcaption>Load of each tooth in % of the total. 0 %: in contact but hardly "
        "loaded; no "
        "number: no contact.</figcaption></figure>\n";
  }

  void contacts() {
    if (bite_.contacts.empty()) return;
    const bool named = !bite_.teeth.empty();
    html_.add(
        "<h2>Contacts</h2>\n<table>\n<tr>{}<th>Side</th><th>Behind the upper incisal "
        "edge</th><th>Marked area</th><th>Gap</th><th>Load, % of total</th></tr>\n",
        named ? "<th>Upper</th><th>Lower</th>" : "");
    for (const auto& contact : bite_.contacts) {
      html_ += "<tr>";
      if (named)
        for (const int fdi : {contact.upper_fdi, contact.lower_fdi})
          html_.add("<td>{}</td>", fdi ? std::to_string(fdi) : "");
      html_.add(
          "<td>{}, {:.1f} mm from the midline</td><td>{:.1f} mm</td><td>{:.2f} mm²</td><td>{:.2f} "
          "mm</td><td>{:.1f} %</td></tr>\n",
          contact.left ? "left" : "right", std::abs(contact.place.x() - bite_.midline_mm),
          contact.place.y() - bite_.upper_edge.y(), contact.area_mm2, contact.gap_mm,
          100 * contact.load_fraction);
    }
    html_ += "</table>\n";
  }

  void explanations() {
    html_.add(
        "<h2>How to read this</h2>\n<ul class=\"small\">\n"
        "<li>The mandible was opened until the teeth were apart and closed on an elastic film by "
        "forces at the first molars of both sides, with soft springs at the condyles. It was "
        "closed {} times from different starting poses; the equilibrium of lowest energy is "
        "shown.{}</li>\n",
        bite_.starts, others());
    html_ +=
        "<li>A contact is where the gap is smaller than the thickness of the film: what "
        "articulating "
        "paper would mark. Load is the force transmitted by the film.</li>\n"
        "<li>Overjet and overbite are the distances from the upper to the lower incisal edges, "
        "parallel and perpendicular to the plane of the upper incisal edge and first molars.</li>\n"
        "<li>The displacement of a condyle is measured from its position in the case. For a case "
        "recorded in centric relation it is the shift into this bite: 0.9 ± 0.5 mm in healthy "
        "adults (Utz 2021).</li>\n"
        "<li>pose.csv contains the bite; motion.csv contains a movement from the start through an "
        "open position to the bite. <code>condyle check CASE --motion pose.csv</code> checks the "
        "bones in this bite.</li>\n";
    html_.add_notes(bite_.notes);
    html_.add_notes(report_.notes);
    html_ += "</ul>\n";
  }

  std::string others() const {
    if (bite_.others.empty()) return " All closings reached it.";
    return fmt::format(" {} other {} of higher energy {} found.", bite_.others.size(),
                       bite_.others.size() == 1 ? "equilibrium" : "equilibria",
                       bite_.others.size() == 1 ? "was" : "were");
  }

  const OcclusionReport& report_;
  const Bite& bite_;
  PageWriter html_;
};

}  // namespace

std::string OcclusionReport::page() const { return OcclusionPage(*this).write(); }

}  // namespace condyle
