#include "tools/recording_identity.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/core/hash.h"
#include "sim/case/tissue_plan_file.h"
#include "tools/tissue_options.h"

namespace condyle {
namespace {

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

std::uint64_t case_hash(const Case& patient) {
  std::uint64_t hash = hash_start;
  for (const auto& part : patient.parts) {
    hash = hash_bytes(part.name.data(), part.name.size(), hash);
    hash = hash_bytes(&part.role, sizeof part.role, hash);
    hash = hash_bytes(&part.carrier, sizeof part.carrier, hash);
    for (const auto& c : part.mesh.colors) hash = hash_bytes(c.data(), 3 * sizeof(float), hash);
    for (const auto& v : part.mesh.vertices) hash = hash_bytes(v.data(), 3 * sizeof(double), hash);
    for (const auto& t : part.mesh.triangles) hash = hash_bytes(t.data(), 3 * sizeof(int), hash);
  }
  for (const auto& [name, point] : patient.landmarks.points)
    hash = hash_bytes(point.data(), 3 * sizeof(double), hash_bytes(name.data(), name.size(), hash));
  for (const auto& rule : patient.pair_rules) {
    const std::string text = fmt::format("{},{},{},{},{}", rule.a, rule.b, policy_name(rule.policy),
                                         rule.gap_mm, rule.margin_mm.value_or(-1));
    hash = hash_bytes(text.data(), text.size(), hash);
  }
  return hash;
}

/// Of every pose that the recording asks for: at the fixed steps and at the frames.
std::uint64_t motion_hash(const Motion& motion, std::span<const double> times, double step_s) {
  std::uint64_t hash = hash_start;
  const auto add = [&](double time_s) {
    const Pose pose = motion.wanted(time_s);
    hash = hash_bytes(pose.R.coeffs().data(), 4 * sizeof(double), hash);
    hash = hash_bytes(pose.t.data(), 3 * sizeof(double), hash);
  };
  for (int i = 0; i * step_s <= motion.duration_s; ++i) add(i * step_s);
  for (const double time_s : times) add(time_s);
  return hash;
}

std::string contact_text(const MotionOptions& options) {
  std::string text = options.respect_contact ? "respected" : "as the motion wants";
  if (options.friction > 0) text += fmt::format(", friction {}", options.friction);
  for (const auto& pair : options.pairs) text += "; " + pair;
  return text;
}

std::string tissue_text(const MotionOptions& options, const Case& patient) {
  if (!options.tissue) return "none";
  const TissuePlan plan = overlaid(patient.tissue, parse_tissue(options.tissue_model));
  return fmt::format("{} {}", options.surface_nodes, tissue_plan_json(plan).dump());
}

}  // namespace

RecordingSheet recording_identity(const Scene& scene, const Motion& motion,
                                  std::span<const double> times_s, double step_s,
                                  const MotionOptions& options) {
  return {{"condyle", CONDYLE_VERSION},
          {"case", hash_text(case_hash(scene.patient))},
          {"motion", motion.name + " " + hash_text(motion_hash(motion, times_s, step_s))},
          {"contact", contact_text(options)},
          {"tissue", tissue_text(options, scene.patient)}};
}

}  // namespace condyle
