#include "sim/report/clearance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sim/motion/measures.h"

namespace condyle {

bool ClearanceCheck::violated() const {
  return std::any_of(pairs.begin(), pairs.end(),
                     [](const PairVerdict& pair) { return pair.violated(); });
}

namespace {

/// Depth at the place that made the pair's depth. A set counts contact where the pair was apart at
/// rest on from the depth at rest; a picture shows the place itself.
struct PlaceDepth {
  double mm = 0;
  bool was_apart = false;
};

PlaceDepth depth_at_place(const ContactSet& set, const PairContact& pair) {
  for (const auto& away : set.away_from_rest)
    if (away.part_a == pair.part_a && away.part_b == pair.part_b && away.touching &&
        pair.rest_depth_mm + away.depth_mm >= pair.depth_mm)
      return {away.depth_mm, true};
  return {pair.depth_mm, false};
}

}  // namespace

namespace {

/// The fixed steps, every row of a recording, and the end.
std::vector<double> check_times(const Motion& motion, double step_s) {
  constexpr double same_s = 1e-9;
  std::vector<double> times = motion.sample_times;
  for (int i = 0; i * step_s < motion.duration_s; ++i) times.push_back(i * step_s);
  times.push_back(motion.duration_s);
  std::sort(times.begin(), times.end());
  times.erase(
      std::unique(times.begin(), times.end(), [](double a, double b) { return b - a < same_s; }),
      times.end());
  return times;
}

}  // namespace

ClearanceCheck check_clearance(const Scene& scene, const Motion& motion, double margin_mm,
                               const SimulatorSettings& settings, const Progress& progress) {
  ClearanceCheck check;
  const auto& parts = scene.patient.parts;
  for (const auto& rest : scene.contacts.at_rest().pairs) {
    const auto& a = parts[static_cast<std::size_t>(rest.part_a)];
    const auto& b = parts[static_cast<std::size_t>(rest.part_b)];
    check.pairs.push_back({.a = a.name,
                           .b = b.name,
                           .teeth = is_teeth(a.role) && is_teeth(b.role),
                           .rest_distance_mm = rest.touching ? 0 : rest.distance_mm,
                           .rest_depth_mm = rest.rest_depth_mm,
                           .least_distance_mm = 1e300});
  }
  check.pairs_csv =
      "frame,time_s,opening_mm,a,b,touching,distance_mm,depth_mm,beyond_rest_mm,contacts,"
      "witness_a_x_mm,witness_a_y_mm,witness_a_z_mm,witness_b_x_mm,witness_b_y_mm,witness_b_z_mm\n";
  const auto times = check_times(motion, settings.step_s);
  check.frames = static_cast<int>(times.size());
  CoronoidClearance coronoids(scene.patient);
  std::vector<bool> touching(check.pairs.size(), false);
  ContactSet previous = scene.contacts.at_rest();
  for (int frame = 0; frame < check.frames; ++frame) {
    const double time = times[static_cast<std::size_t>(frame)];
    const Pose X_CM = motion.wanted(time);
    ContactSet now = scene.contacts.find(X_CM, &previous, settings.threads);
    const Measures measures = measure(scene.patient, X_CM);
    check.opening_mm.push_back(measures.opening_mm);
    check.rotation_deg.push_back(measures.rotation_deg);
    check.time_s.push_back(time);
    coronoids.add(X_CM);
    for (std::size_t i = 0; i < now.pairs.size(); ++i) {
      const auto& pair = now.pairs[i];
      auto& verdict = check.pairs[i];
      const double distance = pair.touching ? 0 : pair.distance_mm;
      const double beyond = pair.depth_mm - pair.rest_depth_mm;
      const PlaceDepth place = depth_at_place(now, pair);
      const bool nearest = distance < verdict.least_distance_mm;
      const bool deepest = beyond > verdict.beyond_rest_mm;
      if (nearest) {
        verdict.least_distance_mm = distance;
        verdict.least_frame = frame;
      }
      if (deepest) {
        verdict.beyond_rest_mm = beyond;
        verdict.deepest_frame = frame;
      }
      if (deepest || (nearest && verdict.beyond_rest_mm == 0)) {
        verdict.worst = pair;
        verdict.worst_depth_mm = place.mm;
        verdict.worst_was_apart = place.was_apart;
      }
      if (pair.touching) {
        if (verdict.first_touch < 0) verdict.first_touch = frame;
        if (verdict.clearance_mm.empty() || !touching[i]) ++verdict.touches;
        ++verdict.touching_frames;
      }
      touching[i] = pair.touching;
      verdict.clearance_mm.push_back(pair.touching ? -place.mm : distance);
      fmt::format_to(std::back_inserter(check.pairs_csv),
                     "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", frame, time,
                     measures.opening_mm, verdict.a, verdict.b, pair.touching ? 1 : 0, distance,
                     pair.depth_mm, std::max(0.0, beyond), pair.contacts.size(), pair.witness_a.x(),
                     pair.witness_a.y(), pair.witness_a.z(), pair.witness_b.x(), pair.witness_b.y(),
                     pair.witness_b.z());
    }
    previous = std::move(now);
    report(progress, "checking", (frame + 1.0) / check.frames);
  }
  for (auto& verdict : check.pairs) {
    verdict.penetrates = verdict.beyond_rest_mm > settings.contact.slack_mm;
    // Bones apart at rest must not touch at all: a thin shell gives no depth to measure.
    if (verdict.rest_depth_mm == 0 && verdict.rest_distance_mm > 0 && verdict.touching_frames > 0)
      verdict.penetrates = true;
    verdict.violates_margin = !verdict.teeth && verdict.least_distance_mm < margin_mm;
  }
  check.coronoids = coronoids.sides();
  check.coronoids_missing = coronoids.missing();
  CloseLook close_look(scene.patient);
  for (std::size_t i = 0; i < check.pairs.size(); ++i) {
    auto& pair = check.pairs[i];
    const auto worst = static_cast<std::size_t>(pair.worst_frame());
    pair.X_CM_worst = motion.wanted(check.time_s[worst]);
    pair.detail = close_look.look(pair.worst, pair.X_CM_worst);
    report(progress, "measuring contacts", (i + 1.0) / static_cast<double>(check.pairs.size()));
  }
  return check;
}

}  // namespace condyle
