#include "sim/operation_page/operation_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.h"
#include "engine/core/html_text.h"
#include "sim/frame/part_names.h"
#include "sim/operation/cut_text.h"
#include "sim/operation/trim_segments.h"
#include "sim/osteotomy/osteotomy_label.h"
#include "sim/plan/move.h"
#include "sim/prediction/predicted_landmarks.h"
#include "sim/report/page_parts.h"

namespace condyle {
namespace {

std::optional<ClinicalFrame> frame_of(const OperationPage& page, std::string& problem) {
  try {
    return clinical_frame(page.operated.patient.landmarks, page.plan.reference);
  } catch (const InputError& error) {
    problem = error.what();
    return std::nullopt;
  }
}

/// Without a name that stands as a word of its own.
std::string without(std::string text, const std::string& name) {
  constexpr std::string_view instead = "the case";
  if (name.empty()) return text;
  const auto in_word = [&](std::size_t at) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) ||
                                text[at] == '_' || static_cast<unsigned char>(text[at]) > 127);
  };
  for (auto at = text.find(name); at != std::string::npos; at = text.find(name, at)) {
    if ((at > 0 && in_word(at - 1)) || in_word(at + name.size())) {
      at += name.size();
      continue;
    }
    text.replace(at, name.size(), instead);
    at += instead.size();
  }
  return text;
}

std::vector<std::string> readable(const std::vector<std::string>& names) {
  std::vector<std::string> words;
  for (const std::string& name : names) words.push_back(readable_name(name));
  return words;
}

/// A move that was given as a pose, about the point that it would have by its words.
std::string pose_words(const MoveStep& step, const Operated& operated, const ClinicalFrame& frame) {
  const ClinicalMove none;
  try {
    const Eigen::Vector3d point = rotation_point(operated, step.segment, none);
    return move_words(clinical_move(std::get<ExplicitMove>(step.move).X_CS, frame, point)) +
           ", placed by hand or by the bite; measured at its " +
           readable_name(point_name(none, step.segment));
  } catch (const InputError&) {
    return "placed by hand or by the bite";
  }
}

/// With a capital at the start; "G-Sn-Pog'" stays.
std::string capitalised(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

class OperationPageWriter {
 public:
  explicit OperationPageWriter(const OperationPage& page)
      : page_(page),
        operated_(page.operated),
        title_(page.title.empty() ? operation_title(page.plan) : page.title),
        html_(title_),
        frame_(frame_of(page, problem_)),
        overlaps_(segment_overlaps(page.operated)) {
    if (!frame_) return;
    const Landmarks& before = operated_.patient.landmarks;
    movements_ = planned_movements(operated_, *frame_);
    const Landmarks after =
        page.prediction ? predicted_landmarks(*page.prediction) : planned_landmarks(operated_);
    measures_ = cephalometry(*frame_, before, after);
  }

  std::string write() {
    head();
    key_figures();
    steps();
    pictures(page_.bones, "wide");
    movements();
    table("Cephalometry", cephalometry_table(measures_, page_.prediction != nullptr),
          cephalometry_legend(operated_) + " They are for comparison, not a target.");
    contacts();
    dangers();
    prediction();
    motion();
    cuts();
    notes();
    return html_.finish();
  }

 private:
  void head() {
    html_.add(
        "<h1>{}</h1>\n<div class=\"verdict\"><strong>For research and education, not for "
        "clinical use.</strong><br>\n<span class=\"small\">Made by {} on {}. Case {}, plan {}: "
        "hashes of their contents, which tell whether a page belongs to them. Directions are "
        "the patient's own.</span></div>\n",
        escaped(title_), escaped(page_.program), escaped(page_.date), escaped(page_.case_hash),
        escaped(page_.plan_hash));
  }

  void table(const std::string& heading, const PageTable& content, const std::string& below = "") {
    if (content.rows.empty()) return;
    html_.add("<h2>{}</h2>\n{}", escaped(heading), table_html(content));
    if (!below.empty()) html_.add("<p class=\"small\">{}</p>\n", escaped(below));
  }

  void pictures(const std::vector<PagePicture>& all, const char* kind = "") {
    for (const PagePicture& picture : all)
      html_.add(
          "<figure><img class=\"{}\" src=\"data:image/png;base64,{}\" alt=\"{}\"><figcaption>{}"
          "</figcaption></figure>\n",
          kind, base64(picture.png), escaped(picture.caption), escaped(picture.caption));
  }

  const CephalometricMeasure* measure(const char* name) const {
    const auto found = std::find_if(measures_.begin(), measures_.end(),
                                    [&](const auto& each) { return each.name == name; });
    return found == measures_.end() || !found->before || !found->after ? nullptr : &*found;
  }

  /// What a reader wants first.
  void key_figures() {
    PageTable figures{{"At a glance", "Before", "After"}, {}};
    for (const char* name : {"ANB", "overjet", "overbite", "facial convexity (G-Sn-Pog')"})
      if (const auto* each = measure(name);
          each && (page_.prediction || std::string_view(name).find("facial") != 0)) {
        const std::string unit = each->unit == "deg" ? "°" : " " + each->unit;
        figures.rows.push_back({capitalised(each->name),
                                fmt::format("{:.1f}{}", *each->before + 0.0, unit),
                                fmt::format("{:.1f}{}", *each->after + 0.0, unit)});
      }
    if (page_.motion)
      for (const ComparedMeasure& each : page_.motion->measures)
        if (each.name == "opening" && each.before && each.after)
          figures.rows.push_back({"Mouth opening", fmt::format("{:.1f} mm", *each.before),
                                  fmt::format("{:.1f} mm", *each.after)});
    for (const char* label : {"U1", "L1", "Pog"})
      for (const MovementRow& row : movements_.rows)
        if (row.label == label && row.distance_mm() > 0.05)
          figures.rows.push_back({fmt::format("{} moves", label), "", displacement(row)});
    if (figures.rows.empty()) return;
    html_ += table_html(figures);
  }

  static std::string displacement(const MovementRow& row) {
    std::vector<std::string> words;
    const auto add = [&](double mm, const char* positive, const char* negative) {
      if (std::abs(mm) >= 0.05) words.push_back(in_words(mm, positive, negative));
    };
    add(row.back_mm, "mm back", "mm forward");
    add(row.up_mm, "mm up", "mm down");
    add(row.left_mm, "mm left", "mm right");
    return fmt::format("{}", fmt::join(words, ", "));
  }

  void steps() {
    html_ += "<h2>The plan</h2>\n<ol>\n";
    int left_out = 0;
    for (const PlanStep& step : page_.plan.steps) {
      if (std::holds_alternative<NoteStep>(step.action) && !page_.shows_notes) {
        ++left_out;
        continue;
      }
      html_.add("<li>{}</li>\n", escaped(step_sentence(step, operated_)));
    }
    html_ += "</ol>\n";
    if (left_out > 0)
      html_.add(
          "<p class=\"small\">{} of the plan {} left out, because notes may name a person."
          "</p>\n",
          left_out == 1 ? "A note" : fmt::format("{} notes", left_out),
          left_out == 1 ? "is" : "are");
  }

  void movements() {
    if (!frame_) {
      html_.add("<p>Tables of movements and cephalometry are left out: {}.</p>\n",
                escaped(cleaned(problem_)));
      return;
    }
    table("Movements of the bone", movements_table(movements_),
          "Of landmarks, from before the operation to the planned position, mm.");
    html_ += table_html(rotations_table(movements_));
    html_ += table_html(midlines_table(movements_));
  }

  void contacts() {
    html_ += "<h2>Contacts and overlaps</h2>\n";
    const PageTable overlaps = overlaps_table(overlaps_);
    if (overlaps.rows.empty())
      html_ += "<p>No bone or teeth overlap at the planned positions.</p>\n";
    else
      html_ += table_html(overlaps);
    if (const Bite* bite = page_.bite) {
      html_.add(
          "<p>Bite: from the planned position the lower arch closes by at most {:.1f} mm into "
          "maximum intercuspation, with {} contacts on {} mm film, {:.0f} % of the load on the "
          "left; overjet {:.1f} mm, overbite {:.1f} mm. {}</p>\n",
          bite->moved_from_rest_mm, bite->contacts.size(), OcclusionSettings{}.film_mm,
          100 * bite->left_fraction, bite->after.overjet_mm, bite->after.overbite_mm,
          bite->stable ? "The bite is stable."
                       : escaped("The bite is not stable: " + bite->unstable_because + "."));
      pictures(page_.bite_pictures);
    }
    if (page_.graft_lines.empty()) return;
    html_ += "<h2>Resections and grafts</h2>\n<ul>\n";
    html_.add_notes(page_.graft_lines);
    html_ += "</ul>\n";
  }

  void dangers() {
    html_ += "<h2>Danger zones</h2>\n";
    const PageTable dangers = dangers_table(operated_);
    const bool any_known = std::any_of(operated_.cuts.begin(), operated_.cuts.end(),
                                       [](const CutReport& cut) { return !cut.dangers.empty(); });
    if (operated_.cuts.empty())
      html_ += "<p>The plan has no cut.</p>\n";
    else if (!any_known)
      html_ +=
          "<p>No tooth, nerve canal or foramen is known near the cuts: the case may lack "
          "them.</p>\n";
    else if (dangers.rows.empty())
      html_ +=
          "<p>Every cut keeps its distance from the teeth, nerve canals and foramina that the "
          "case has.</p>\n";
    else
      html_ += table_html(dangers);
  }

  void prediction() {
    if (!page_.prediction || !frame_) return;
    html_ += "<h2>Prediction of the face</h2>\n";
    pictures(page_.face);
    html_ += table_html(soft_points_table(*page_.prediction, *frame_));
    html_.add(
        "<p class=\"small\">The face moves by at most {:.1f} mm. A prediction is a simulation "
        "of soft tissue at rest; swelling, growth and muscles that adapt are not part of "
        "it.</p>\n",
        page_.prediction->max_displacement_mm());
    const std::vector<SoftRatio> ratios = soft_ratios(*page_.prediction, *frame_);
    if (!ratios.empty()) {
      html_.add(
          "<h3>Ratios of soft tissue to bone</h3>\n{}<p class=\"small\">Sagittal movement. "
          "Published ranges are averages over patients.",
          table_html(ratio_table(ratios)));
      for (const std::string& sentence : ratios_outside(ratios))
        html_.add(" {}.", escaped(sentence));
      html_ += "</p>\n";
    }
    if (page_.prediction->unsettled_mm > 0.1)
      html_.add("<p>The solution oscillates by up to {:.1f} mm.</p>\n",
                page_.prediction->unsettled_mm);
  }

  void motion() {
    if (!page_.motion) return;
    table("Range of motion", range_of_motion_table(*page_.motion),
          "In the same movements of the bones before and after the operation. Opening is the "
          "largest; "
          "protrusion and laterotrusion go as far as prescribed, unless bones or teeth stop them.");
    if (page_.motion->pairs.empty()) return;
    html_.add(
        "<h3>Least distance of bones and teeth during these movements</h3>\n{}"
        "<p class=\"small\">Overlap of segments of one bone is bone that the surgeon trims."
        "</p>\n",
        table_html(clearances_table(*page_.motion)));
  }

  void cuts() {
    table("Segments", bones_table(operated_));
    if (operated_.cuts.empty()) return;
    html_ += "<h2>Cuts in detail</h2>\n";
    for (const CutReport& cut : operated_.cuts) {
      html_.add("<p><strong>Step {}, {}</strong></p>\n<ul>\n", cut.step,
                escaped(readable_name(cut.bone)));
      html_.add_notes(cleaned(cut_sentences(cut, operated_.patient.landmarks)));
      html_ += "</ul>\n";
    }
    for (const TrimReport& trim : operated_.trims) {
      html_.add("<p><strong>Step {}, trim of {}</strong></p>\n<ul>\n", trim.step,
                escaped(readable_name(trim.part)));
      html_.add_notes(cleaned(trim_sentences(trim)));
      html_ += "</ul>\n";
    }
  }

  void notes() {
    std::vector<std::string> all = operated_.problems;
    all.insert(all.end(), operated_.notes.begin(), operated_.notes.end());
    all.insert(all.end(), page_.remarks.begin(), page_.remarks.end());
    if (all.empty()) return;
    html_ += "<h2>Remarks</h2>\n<ul>\n";
    html_.add_notes(cleaned(all));
    html_ += "</ul>\n";
  }

  /// A sentence with readable names, without those of case and plan.
  std::string cleaned(std::string text) const {
    for (const std::string& name :
         {operated_.patient.name, page_.plan.name, page_.plan.geometry.name})
      if (!operated_.patient.bodies.find(name)) text = without(std::move(text), name);
    return with_readable_names(std::move(text), names());
  }
  std::vector<std::string> cleaned(std::vector<std::string> texts) const {
    for (std::string& text : texts) text = cleaned(std::move(text));
    return texts;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const Body& body : operated_.patient.bodies.bodies()) all.push_back(body.name);
    for (const auto& [name, point] : operated_.patient.landmarks.points) all.push_back(name);
    return all;
  }

  const OperationPage& page_;
  const Operated& operated_;
  std::string title_, problem_;
  PageWriter html_;
  std::optional<ClinicalFrame> frame_;
  std::vector<SegmentOverlap> overlaps_;
  MovementTable movements_;
  std::vector<CephalometricMeasure> measures_;
};

}  // namespace

std::string operation_page(const OperationPage& page) { return OperationPageWriter(page).write(); }

std::string operation_title(const Plan& plan) {
  std::vector<std::string> words;
  for (const PlanStep& step : plan.steps) {
    std::string word;
    if (const auto* cut = std::get_if<CutStep>(&step.action))
      word = cut->osteotomy.empty() ? "drawn osteotomy" : osteotomy_label(cut->osteotomy);
    if (std::holds_alternative<ResectStep>(step.action)) word = "resection";
    if (std::holds_alternative<GraftStep>(step.action)) word = "graft";
    if (!word.empty() && std::find(words.begin(), words.end(), word) == words.end())
      words.push_back(word);
  }
  if (words.empty()) return "Plan of an operation";
  for (std::size_t i = 1; i < words.size(); ++i)
    if (!words[i].starts_with("Le Fort") && !words[i].starts_with("Inverted"))
      words[i][0] = static_cast<char>(std::tolower(static_cast<unsigned char>(words[i][0])));
  words[0] = display_name(words[0]);
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string step_sentence(const PlanStep& step, const Operated& operated) {
  if (const auto* cut = std::get_if<CutStep>(&step.action)) {
    std::string text = cut->osteotomy.empty() ? "Drawn osteotomy" : osteotomy_label(cut->osteotomy);
    if (!cut->target.empty()) text += " of the " + readable_name(cut->target);
    if (cut->kerf_mm > 0) text += fmt::format(", saw cut of {:g} mm", cut->kerf_mm);
    for (const auto& [name, value] : cut->parameters)
      text += fmt::format(", {} {:g}", readable_name(name), value);
    if (!cut->pieces.empty())
      text += fmt::format("; segments: {}", fmt::join(readable(cut->pieces), ", "));
    if (cut->below_margins) text += "; below the least margins on request";
    return text;
  }
  if (const auto* move = std::get_if<MoveStep>(&step.action)) {
    const std::string segment = display_name(move->segment);
    if (const auto* words = std::get_if<ClinicalMove>(&move->move))
      return fmt::format("{}: {}, about {}", segment, move_words(*words),
                         readable_name(point_name(*words, move->segment)));
    try {
      return segment + ": " +
             pose_words(*move, operated, clinical_frame(operated.patient.landmarks));
    } catch (const InputError&) {
      return segment + ": placed by hand or by the bite";
    }
  }
  if (const auto* trim = std::get_if<TrimStep>(&step.action))
    return fmt::format("{}: bone that overlaps {} is trimmed", display_name(trim->segment),
                       fmt::join(readable(trim->of), ", "));
  if (const auto* note = std::get_if<NoteStep>(&step.action)) return "Note: " + note->text;
  return display_name(readable_name(step_title(step.action))) + ": " + step_details(step.action);
}

}  // namespace condyle
