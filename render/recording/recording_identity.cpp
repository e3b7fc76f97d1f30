#include "render/recording/recording_identity.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "engine/core/hash.h"
#include "sim/case/face_muscle_table.h"
#include "sim/case/tissue_plan_file.h"

namespace condyle {
namespace {

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

std::string rule_text(const PairRule& rule) {
  return fmt::format("{},{},{},{},{}", rule.a, rule.b, policy_name(rule.policy), rule.gap_mm,
                     rule.margin_mm.value_or(-1));
}

std::uint64_t case_hash(const Case& patient) {
  std::uint64_t hash = hash_start;
  for (const auto& part : patient.parts) {
    hash = hash_bytes(part.name.data(), part.name.size(), hash);
    hash = hash_bytes(&part.role, sizeof part.role, hash);
    hash = hash_bytes(&part.body, sizeof part.body, hash);
    for (const auto& c : part.mesh.colors) hash = hash_bytes(c.data(), 3 * sizeof(float), hash);
    for (const auto& v : part.mesh.vertices) hash = hash_bytes(v.data(), 3 * sizeof(double), hash);
    for (const auto& t : part.mesh.triangles) hash = hash_bytes(t.data(), 3 * sizeof(int), hash);
  }
  for (const Body& body : patient.bodies.bodies()) {
    hash = hash_bytes(body.name.data(), body.name.size(), hash);
    hash = hash_bytes(&body.parent, sizeof body.parent, hash);
    hash = hash_bytes(&body.driver, sizeof body.driver, hash);
  }
  for (const auto& [name, point] : patient.landmarks.points)
    hash = hash_bytes(point.data(), 3 * sizeof(double), hash_bytes(name.data(), name.size(), hash));
  for (const auto& rule : patient.pair_rules) {
    const std::string text = rule_text(rule);
    hash = hash_bytes(text.data(), text.size(), hash);
  }
  return hash;
}

/// Hash of every pose and expression that the recording uses: at the fixed steps and at the frames.
std::uint64_t motion_hash(const Motion& motion, std::span<const double> times, double step_s) {
  std::uint64_t hash = hash_start;
  const auto add = [&](double time_s) {
    const Pose pose = motion.target(time_s);
    hash = hash_bytes(pose.R.coeffs().data(), 4 * sizeof(double), hash);
    hash = hash_bytes(pose.t.data(), 3 * sizeof(double), hash);
    if (!motion.expression) return;
    const FaceExcitation excitation = motion.expression(time_s);
    hash = hash_bytes(excitation.muscles.data(), excitation.muscles.size() * sizeof(double), hash);
    if (!excitation.moves_lids()) return;
    const LidClosure lids = excitation.closure();
    const double closed[] = {lids.left, lids.right};
    hash = hash_bytes(closed, sizeof closed, hash);
  };
  for (int i = 0; i * step_s <= motion.duration_s; ++i) add(i * step_s);
  for (const double time_s : times) add(time_s);
  if (const LidStrength& lids = motion.lid_strength; lids != LidStrength{}) {
    const double strengths[] = {lids.left, lids.right};
    hash = hash_bytes(strengths, sizeof strengths, hash);
  }
  return hash;
}

std::string contact_text(const ContactSettings& settings, bool respect_contact) {
  std::string text = respect_contact ? "respected" : "as the motion wants";
  if (settings.friction > 0) text += fmt::format(", friction {}", settings.friction);
  for (const auto& rule : settings.pair_rules) text += "; " + rule_text(rule);
  return text;
}

std::string tissue_text(const SimulatorSettings& settings, const Case& patient,
                        const TissueModel* tissue) {
  if (!settings.tissue) return "none";
  const TissuePlan plan = overlaid(patient.tissue, settings.tissue_model.plan);
  const std::string muscles = tissue ? face_muscles_csv(face_muscles_of(*tissue)) : "";
  return fmt::format("{} {} {}{}", settings.tissue_model.surface_nodes,
                     tissue_plan_json(plan).dump(),
                     hash_text(hash_bytes(muscles.data(), muscles.size(), hash_start)),
                     settings.tissue_model.upper_face ? " with the upper face" : "");
}

}  // namespace

RecordingSheet recording_identity(const Scene& scene, const Motion& motion,
                                  std::span<const double> times_s,
                                  const SimulatorSettings& settings, bool respect_contact) {
  RecordingSheet sheet{
      {"condyle", CONDYLE_VERSION},
      {"case", hash_text(case_hash(scene.patient))},
      {"motion", motion.name + " " + hash_text(motion_hash(motion, times_s, settings.step_s))},
      {"contact", contact_text(settings.contact, respect_contact)},
      {"tissue", tissue_text(settings, scene.patient, scene.tissue.get())}};
  if (scene.plan) sheet["plan"] = scene.plan->name + " " + scene.plan->hash;
  return sheet;
}

}  // namespace condyle
