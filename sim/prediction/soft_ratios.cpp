#include "sim/prediction/soft_ratios.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace condyle {
namespace {

using Json = nlohmann::ordered_json;

/// What the operation moves: `lower_alone` is the whole lower jaw, and nothing of the upper.
enum class Moves { any, chin_alone, lower_jaw, lower_alone };

struct PublishedRatio {
  const char *soft, *hard;
  bool forward;
  Moves moves;
  std::optional<double> low, high;
  const char* source = "";
  const char* limit = "";  // of the model, where it may leave the range
};
constexpr const char* lip_forward =
    "the upper lip follows the teeth whole: it does not thin in the model";
constexpr const char* lip_back = "the lips do not stick to each other in the model";
constexpr const char* stomion_limit =
    "stomion is one point of the skin and follows the lip on which it lies";
constexpr const char* corner_limit =
    "the corners follow both lips, which do not stick to each other";
constexpr const char* chin_back = "the ledge above the cut holds the tissue back where it is high";
// Naoumova 2008: Eur J Orthod 30:359 (42 patients). Kim 2010: Angle Orthod 80:896 (26 patients),
// whose landmarks are given as parts of soft B', which moves as the bone does.
const std::array published{
    PublishedRatio{"pronasale", "a_point", true, Moves::any, 0.2, 0.35, "textbooks"},
    PublishedRatio{"subnasale", "a_point", true, Moves::any, 0.5, 0.6, "textbooks"},
    PublishedRatio{"labrale_superius", "upper_incisal_point", true, Moves::any, 0.6, 0.9,
                   "textbooks", lip_forward},
    PublishedRatio{"labrale_superius", "upper_incisal_point", false, Moves::any, {}, {}},
    PublishedRatio{"soft_pogonion", "pogonion", true, Moves::chin_alone, 0.85, 1.0, "textbooks"},
    PublishedRatio{"soft_pogonion", "pogonion", false, Moves::chin_alone, 0.6, 0.8, "textbooks",
                   chin_back},
    PublishedRatio{"labrale_inferius", "lower_incisal_point", true, Moves::lower_jaw, 0.6, 0.8,
                   "textbooks"},
    PublishedRatio{"soft_b_point", "b_point", true, Moves::lower_jaw, {}, {}},
    PublishedRatio{"soft_pogonion", "pogonion", true, Moves::lower_jaw, 0.9, 1.0, "textbooks"},
    PublishedRatio{"labrale_superius", "b_point", false, Moves::lower_alone, 0.15, 0.15, "Kim 2010",
                   lip_back},
    PublishedRatio{"stomion", "b_point", false, Moves::lower_alone, 0.24, 0.24, "Kim 2010",
                   stomion_limit},
    PublishedRatio{"left_cheilion", "b_point", false, Moves::lower_alone, 0.51, 0.51, "Kim 2010",
                   corner_limit},
    PublishedRatio{"right_cheilion", "b_point", false, Moves::lower_alone, 0.51, 0.51, "Kim 2010",
                   corner_limit},
    PublishedRatio{"labrale_inferius", "lower_incisal_point", false, Moves::lower_jaw, 0.6, 1.03,
                   "textbooks; Kim 2010"},
    PublishedRatio{"soft_b_point", "b_point", false, Moves::lower_jaw, 0.9, 1.1,
                   "textbooks; Naoumova 2008"},
    PublishedRatio{"soft_pogonion", "pogonion", false, Moves::lower_jaw, 0.9, 1.1,
                   "textbooks; Naoumova 2008"}};

const SoftPoint* find_point(const Prediction& prediction, const std::string& name) {
  for (const SoftPoint& point : prediction.points)
    if (point.landmark == name) return &point;
  return nullptr;
}

/// What the surgeon lifts off the bone.
std::string stripping_text(const Stripping& stripping) {
  std::string text =
      fmt::format("soft tissue stripped from bone: {} of {} attachments ({} within {:g} mm of cuts",
                  stripping.stripped(), stripping.attachments, stripping.near_cuts,
                  stripping.settings.reach_mm);
  if (stripping.resected > 0) text += fmt::format(", {} on resected bone", stripping.resected);
  if (stripping.on_maxilla > 0)
    text += fmt::format(", {} on the front of the maxilla", stripping.on_maxilla);
  if (stripping.above_chin > 0) text += fmt::format(", {} above the chin", stripping.above_chin);
  if (stripping.on_chin > 0) text += fmt::format(", {} in part on the chin", stripping.on_chin);
  return text + ")";
}

std::string literature_text(const SoftRatio& row) {
  return row.low ? fmt::format("{} ({})", published_range(row), row.source) : "unknown";
}

/// Outside a published range, or farther than 0.1 from a published mean.
bool is_outside(const SoftRatio& row) {
  if (!row.low) return false;
  const double beside = *row.low < *row.high ? 0 : 0.1;
  return row.ratio() < *row.low - beside || row.ratio() > *row.high + beside;
}

std::string spaced(std::string name) {
  for (char& c : name)
    if (c == '_') c = ' ';
  return name;
}

}  // namespace

std::string published_range(const SoftRatio& row) {
  if (!row.low) return "";
  return *row.low < *row.high ? fmt::format("{:g} to {:g}", *row.low, *row.high)
                              : fmt::format("{:g}", *row.low);
}

std::vector<std::string> ratios_outside(const std::vector<SoftRatio>& ratios) {
  std::vector<std::string> sentences;
  for (const SoftRatio& row : ratios)
    if (is_outside(row))
      sentences.push_back(fmt::format("{} ({:.2f}) is outside the published {}{}{}",
                                      spaced(row.soft), row.ratio(), published_range(row),
                                      row.limit.empty() ? "" : ": ", row.limit));
  return sentences;
}

std::vector<SoftRatio> soft_ratios(const Prediction& prediction, const ClinicalFrame& frame) {
  constexpr double least_mm = 0.5;
  const Landmarks& rest = prediction.operated.patient.landmarks;
  const Landmarks moved = planned_landmarks(prediction.operated);
  const auto moves = [&](const char* landmark) {
    const auto before = rest.find(landmark), after = moved.find(landmark);
    return before && after && (*after - *before).norm() > least_mm;
  };
  const bool lower = moves("b_point"), upper = moves("a_point");
  const auto is_of = [&](Moves kind) {
    switch (kind) {
      case Moves::chin_alone:
        return !lower;
      case Moves::lower_jaw:
        return lower;
      case Moves::lower_alone:
        return lower && !upper;
      case Moves::any:
        break;
    }
    return true;
  };
  std::vector<SoftRatio> ratios;
  for (const auto& row : published) {
    const auto before = rest.find(row.hard), after = moved.find(row.hard);
    const SoftPoint* soft = find_point(prediction, row.soft);
    if (!before || !after || !soft) continue;
    const double hard_mm = -frame.back.dot(*after - *before);
    if (std::abs(hard_mm) < least_mm || (hard_mm > 0) != row.forward) continue;
    if (!is_of(row.moves)) continue;
    ratios.push_back({row.soft, row.hard, hard_mm, -frame.back.dot(soft->after - soft->before),
                      row.low, row.high, row.source, ""});
    if (SoftRatio& ratio = ratios.back(); is_outside(ratio)) ratio.limit = row.limit;
  }
  return ratios;
}

std::string prediction_text(const Prediction& prediction, const ClinicalFrame& frame) {
  std::string text = fmt::format("{:<20}{:>14}{:>14}{:>12}{:>10}\n", "soft tissue, mm",
                                 "right-left", "back-forward", "down-up", "distance");
  for (const auto& [name, before, after] : prediction.points) {
    const Eigen::Vector3d step = after - before;
    text += fmt::format("{:<20}{:>14}{:>14}{:>12}{:>10.1f}\n", spaced(name),
                        in_words(frame.left.dot(step), "left", "right"),
                        in_words(-frame.back.dot(step), "forward", "back"),
                        in_words(frame.up.dot(step), "up", "down"), step.norm());
  }
  const auto ratios = soft_ratios(prediction, frame);
  if (!ratios.empty())
    text += fmt::format("\n{:<20}{:<22}{:>8}{:>8}{:>8}  {}\n", "soft to hard, forward", "  of",
                        "hard mm", "soft mm", "ratio", "literature");
  for (const SoftRatio& row : ratios)
    text +=
        fmt::format("{:<20}  {:<21}{:>8.1f}{:>8.1f}{:>8.2f}  {}\n", spaced(row.soft),
                    spaced(row.hard), row.hard_mm, row.soft_mm, row.ratio(), literature_text(row));
  for (const std::string& sentence : ratios_outside(ratios)) text += sentence + "\n";
  if (const Stripping& stripping = prediction.stripping; stripping.stripped() > 0)
    text += fmt::format("\n{}\n", stripping_text(stripping));
  text += fmt::format(
      "\nthe face moves by at most {:.1f} mm; {} inverted prisms; solved in {:.1f} s{}\n",
      prediction.max_displacement_mm(), prediction.state.inverted_prisms, prediction.time_s,
      prediction.state.converged
          ? ""
          : fmt::format("; the solution oscillates, and the face with it by at most {:.2f} mm",
                        prediction.unsettled_mm));
  return text;
}

Json prediction_json(const Prediction& prediction, const ClinicalFrame& frame) {
  Json json{{"max_displacement_mm", prediction.max_displacement_mm()},
            {"inverted_prisms", prediction.state.inverted_prisms},
            {"converged", prediction.state.converged},
            {"unsettled_mm", prediction.unsettled_mm},
            {"time_s", prediction.time_s},
            {"points", Json::array()},
            {"ratios", Json::array()}};
  for (const auto& [name, before, after] : prediction.points) {
    const Eigen::Vector3d step = after - before;
    json["points"].push_back({{"landmark", name},
                              {"left_mm", frame.left.dot(step)},
                              {"forward_mm", -frame.back.dot(step)},
                              {"up_mm", frame.up.dot(step)},
                              {"distance_mm", step.norm()}});
  }
  const Stripping& stripping = prediction.stripping;
  json["stripping"] = {{"attachments", stripping.attachments},
                       {"near_cuts", stripping.near_cuts},
                       {"on_maxilla", stripping.on_maxilla},
                       {"above_chin", stripping.above_chin},
                       {"on_chin", stripping.on_chin},
                       {"on_resected_bone", stripping.resected},
                       {"reach_mm", stripping.settings.reach_mm},
                       {"remains_near_cuts", stripping.settings.near_cut},
                       {"remains_on_maxilla", stripping.settings.on_maxilla},
                       {"remains_above_chin", stripping.settings.above_chin},
                       {"remains_on_chin", stripping.settings.on_chin},
                       {"freed_above_chin_mm", stripping.settings.freed_mm},
                       {"remains_of_septum", stripping.settings.septum}};
  for (const SoftRatio& row : soft_ratios(prediction, frame)) {
    Json entry{{"soft", row.soft},
               {"hard", row.hard},
               {"hard_mm", row.hard_mm},
               {"soft_mm", row.soft_mm},
               {"ratio", row.ratio()}};
    if (row.low)
      entry["published"] = {{"low", *row.low}, {"high", *row.high}, {"source", row.source}};
    if (!row.limit.empty()) entry["limit"] = row.limit;
    json["ratios"].push_back(std::move(entry));
  }
  return json;
}

}  // namespace condyle
