#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim/report/clearance.h"

namespace condyle {
namespace {

// Tolerated overlap of the two faces of a cut, whose meshes may differ.
constexpr double cut_overlap_mm = 0.1;

// Below the accuracy of contact.
constexpr double min_overlap_mm = 0.05;

std::string number(double mm) { return fmt::format("{:.2f} mm", mm); }

}  // namespace

void apply_rule(PairVerdict& pair, double slack_mm) {
  slack_mm = std::max(slack_mm, min_overlap_mm);
  // Coincident copies have no deep points, but a large common volume.
  const auto& worst = pair.worst;
  const double thick_mm =
      worst.measure.area_mm2 > 0 ? worst.measure.volume_mm3 / worst.measure.area_mm2 : 0;
  pair.coincide = worst.sample.contact.touching && worst.measure.volume_known &&
                  thick_mm > 2 * worst.sample.depth_mm + 2 * cut_overlap_mm;
  const bool apart_at_rest = pair.rest_distance_mm > 0;
  // Bones that are apart at rest must not touch at all: a thin shell has no measurable depth.
  const bool meets = (apart_at_rest && pair.first_touch) || pair.beyond_rest_mm > slack_mm;
  const bool nears = pair.min_distance_mm < pair.required_mm;
  switch (pair.rule.policy) {
    case PairPolicy::forbidden:
    case PairPolicy::guided:
      pair.collides = meets;
      pair.at_rest = pair.rest_distance_mm < pair.required_mm;
      pair.too_close = nears && !pair.at_rest;
      break;
    case PairPolicy::allowed:
      pair.collides = pair.beyond_rest_mm > slack_mm;
      break;
    case PairPolicy::cut_face:
      pair.at_rest = pair.rest_depth_mm > cut_overlap_mm;
      pair.collides = pair.beyond_rest_mm > (pair.at_rest ? slack_mm : cut_overlap_mm);
      break;
  }
}

std::string tenths(double value) {
  return fmt::format("{:.1f}", std::abs(value) < 0.05 ? 0.0 : value);
}

std::string rule_text(const PairVerdict& pair) {
  switch (pair.rule.policy) {
    case PairPolicy::allowed:
      return "may touch, must not overlap more than at rest";
    case PairPolicy::guided:
      return "guided: must keep a gap of " + number(pair.required_mm);
    case PairPolicy::cut_face:
      return "cut faces: may touch, must not overlap by more than " + number(cut_overlap_mm);
    case PairPolicy::forbidden:
      break;
  }
  return pair.required_mm > 0 ? "must stay " + number(pair.required_mm) + " apart"
                              : "must not touch";
}

std::string verdict_text(const PairVerdict& pair) {
  const bool guided = pair.rule.policy == PairPolicy::guided;
  const std::string asked = guided ? "gap" : "margin";
  std::string words;
  const auto add = [&words](const std::string& more) {
    words += (words.empty() ? "" : "; ") + more;
  };
  if (pair.coincide)
    add(fmt::format("they occupy the same space: {:.0f} mm\u00b3 in common",
                    pair.worst.measure.volume_mm3));
  if (pair.collides) {
    const MotionTime& when = pair.beyond_rest_mm > 0 ? pair.deepest_at : *pair.first_touch;
    const std::string at = " at " + tenths(when.opening_mm) + " mm opening";
    constexpr double reported_mm = 0.005;  // smaller values would read 0.00
    if (pair.beyond_rest_mm >= reported_mm && pair.rest_depth_mm > 0)
      add("the motion makes them overlap " + number(pair.beyond_rest_mm) + " more than at rest" +
          at);
    else if (pair.beyond_rest_mm >= reported_mm)
      add("the motion makes them overlap by " + number(pair.beyond_rest_mm) + at);
    else
      add("the motion makes them meet" + at);
  } else if (pair.too_close) {
    add(fmt::format("the motion brings them to {} at {} mm opening, closer than the {} of {}",
                    number(pair.min_distance_mm), tenths(pair.min_distance_at.opening_mm), asked,
                    number(pair.required_mm)));
  }
  if (pair.at_rest) {
    if (pair.rest_depth_mm > 0)
      add("overlap at rest (" + number(pair.rest_depth_mm) + ")");
    else
      add(fmt::format("closer than the {} of {} at rest ({})", asked, number(pair.required_mm),
                      number(pair.rest_distance_mm)));
    if (!pair.collides && pair.rest_distance_mm > 0 && pair.min_distance_mm < pair.rest_distance_mm)
      add(fmt::format("the motion brings them to {} at {} mm opening", number(pair.min_distance_mm),
                      tenths(pair.min_distance_at.opening_mm)));
    else if (!pair.collides)
      add("the motion does not make it worse");
  }
  if (!words.empty()) return words;
  if (pair.rest_depth_mm > 0)
    return "overlap by " + number(pair.rest_depth_mm) + " at rest, " +
           (pair.beyond_rest_mm >= 0.005 ? "at most " + number(pair.beyond_rest_mm) + " more"
                                         : "never more") +
           " during the motion";
  if (pair.beyond_rest_mm > 0)
    return "touch, with an overlap of at most " + number(pair.beyond_rest_mm);
  if (pair.first_touch) return "touch without overlap";
  if (guided)
    return fmt::format("keep a gap of {} (at {} mm opening) to {} (at {} mm opening)",
                       number(pair.min_distance_mm), tenths(pair.min_distance_at.opening_mm),
                       number(pair.max_distance_mm), tenths(pair.max_distance_at.opening_mm));
  return fmt::format("stay at least {} apart, closest at {} mm opening",
                     number(pair.min_distance_mm), tenths(pair.min_distance_at.opening_mm));
}

}  // namespace condyle
