#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "sim/report/check_page.h"

namespace condyle {

std::vector<std::size_t> worst_first(const ClearanceCheck& check) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < check.pairs.size(); ++i) order.push_back(i);
  const auto rank = [&](std::size_t i) {
    const auto& pair = check.pairs[i];
    const int kind = pair.collides ? 0 : pair.too_close ? 1 : pair.at_rest ? 2 : 3;
    // Pairs that may touch rank after pairs that may not.
    const bool may_touch =
        pair.rule.policy == PairPolicy::allowed || pair.rule.policy == PairPolicy::cut_face;
    return std::tuple(kind, kind == 3 && may_touch, -pair.beyond_rest_mm, pair.min_distance_mm,
                      -pair.rest_depth_mm);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return rank(i) < rank(j); });
  return order;
}

std::vector<std::size_t> pairs_to_show(const ClearanceCheck& check, std::size_t most) {
  const bool any = check.violated();
  std::vector<std::size_t> shown;
  for (const std::size_t i : worst_first(check))
    if (shown.size() < most && (!any || check.pairs[i].violated())) shown.push_back(i);
  return shown;
}

std::string summary_text(const ClearanceCheck& check) {
  if (check.pairs.empty())
    return "Nothing to check: no two bones of this case move relative to each other.";
  int collide = 0, near = 0, rest = 0, overlap = 0;
  constexpr double reported_overlap_mm = 0.05;
  for (const auto& pair : check.pairs) {
    collide += pair.collides;
    near += !pair.collides && pair.too_close;
    rest += !pair.collides && !pair.too_close && (pair.at_rest || pair.coincide);
    overlap += pair.rest_depth_mm > reported_overlap_mm;
  }
  if (!check.violated()) {
    const std::string words =
        "No violation. Every pair complies with its rule throughout the motion";
    if (overlap == 0) return words + ".";
    return words + fmt::format(", but {} {} at rest.", overlap,
                               overlap == 1 ? "pair overlaps" : "pairs overlap");
  }
  std::string words;
  const auto add = [&](int count, const char* one, const char* several) {
    if (count > 0)
      words += fmt::format("{}{} {}", words.empty() ? "" : ", ", count, count == 1 ? one : several);
  };
  add(collide, "collides", "collide");
  add(near, "comes too close", "come too close");
  add(rest, "breaks its rule at rest", "break their rule at rest");
  return fmt::format("Violation. Among {} {}, {}.", check.pairs.size(),
                     check.pairs.size() == 1 ? "pair" : "pairs", words);
}

std::string open_surface_text(const PairVerdict& pair) {
  const bool open_a = pair.worst.measure.open_a, open_b = pair.worst.measure.open_b;
  if (open_a && open_b)
    return "Both surfaces are open and have no inside: near the openings, distance is shown "
           "unsigned, "
           "as if they were apart.";
  if (!open_a && !open_b) return "";
  return fmt::format(
      "The surface of {0} is open and has no inside: near the openings, distance on {1} is shown "
      "unsigned, as if they were apart.",
      open_a ? pair.a : pair.b, open_a ? pair.b : pair.a);
}

std::string push_out_text(const PairVerdict& pair) {
  const Eigen::Vector3d& out = *pair.push_out_mm;
  const auto along = [](double mm, const char* plus, const char* minus) {
    return fmt::format("{:.2f} mm {}", std::abs(mm), mm >= 0 ? plus : minus);
  };
  return fmt::format("At rest, moving {} by {}, {} and {} ({:.2f} mm) separates the two.", pair.b,
                     along(out.x(), "left", "right"), along(out.y(), "back", "forward"),
                     along(out.z(), "up", "down"), out.norm());
}

std::string worst_moment(const PairVerdict& pair) {
  const MotionTime& when = pair.worst.when;
  return fmt::format("{} mm opening, {}° rotation ({:.2f} s{})", tenths(when.opening_mm),
                     tenths(when.rotation_deg), when.time_s,
                     when.between ? ", between two frames" : "");
}

std::string worst_place(const PairVerdict& pair) {
  const auto& measure = pair.worst.measure;
  const char* noun = measure.side == "both" ? " sides" : measure.side == "middle" ? "" : " side";
  return measure.side + noun + ", " + measure.region();
}

std::string worst_caption(const PairVerdict& pair) {
  const auto& [when, sample, measure, poses] = pair.worst;
  std::string text;
  if (!sample.contact.touching)
    text = fmt::format("{:.2f} mm apart", sample.contact.distance_mm);
  else if (sample.was_apart)
    text = fmt::format("{:.2f} mm deep at a point where they are apart at rest", sample.depth_mm);
  else if (sample.beyond_rest_mm() > 0 && pair.rest_depth_mm > 0)
    text = fmt::format("{:.2f} mm deep, {:.2f} mm deeper than at rest", sample.depth_mm,
                       sample.beyond_rest_mm());
  else if (sample.beyond_rest_mm() > 0)
    text = fmt::format("{:.2f} mm deep", sample.depth_mm);
  else
    text = pair.rest_depth_mm > 0
               ? fmt::format("{:.2f} mm deep, no deeper than at rest", sample.depth_mm)
               : "touching";
  text += " at " + worst_moment(pair);
  if (sample.contact.touching) {
    text += fmt::format("; contact {:.1f} mm² (within 0.1 mm) in {} {}", measure.area_mm2,
                        measure.patches, measure.patches == 1 ? "patch" : "patches");
    text += measure.volume_known ? fmt::format(", overlap {:.1f} mm³", measure.volume_mm3)
                                 : ", overlap volume unknown: open surface";
  }
  return text + "; " + worst_place(pair);
}

}  // namespace condyle
