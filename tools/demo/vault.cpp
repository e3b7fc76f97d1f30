#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "engine/mesh/measure.h"
#include "engine/mesh_io/mesh_files.h"
#include "sim/case/case_io.h"
#include "sim/operation/cut_text.h"
#include "sim/phantom/phantom.h"
#include "tools/common.h"
#include "tools/demo/demo.h"
#include "tools/demo/operation_output.h"
#include "tools/demo/plan_steps.h"
#include "tools/demo/skull_landmarks.h"

namespace condyle {
namespace {

/// Greatest length and breadth of the brain case along the patient's axes, mm.
struct VaultSize {
  double length_mm = 0, breadth_mm = 0;
  double cephalic_index() const { return 100 * breadth_mm / length_mm; }
};

/// Of the bone more than 20 mm above the Frankfort plane, which leaves out face and mastoids.
VaultSize vault_size(const Operated& operated, const ClinicalFrame& frame, bool planned) {
  const auto porion = operated.patient.landmarks.find("left_porion");
  const Eigen::Vector3d level = porion.value_or(frame.origin);
  Box box;
  for (const Part& part : operated.patient.parts) {
    if (part.role != Role::skull && part.role != Role::segment) continue;
    const Pose X = planned ? operated.poses[part.body] : Pose{};
    for (const Eigen::Vector3d& p : part.mesh.vertices) {
      const Eigen::Vector3d at = frame.components(X * p - level);
      if (at.z() > 20) box.add(at);
    }
  }
  return {box.size().y(), box.size().x()};
}

struct VaultPatient {
  Case patient;
  std::vector<std::string> notes;
};

VaultPatient delivered_skull(const DemoOptions& options) {
  VaultPatient result;
  if (!options.landmarks.empty()) {
    result.patient = import_meshes({.files = {{Role::skull, options.skull}},
                                    .landmarks = options.landmarks,
                                    .name = options.skull.stem().string()});
    return result;
  }
  result.patient = import_meshes({.files = {{Role::skull, options.skull}},
                                  .landmarks = {},
                                  .name = options.skull.stem().string()});
  result.patient.landmarks = estimate_skull_landmarks(result.patient.find(Role::skull)->mesh);
  result.notes.push_back(
      "nasion, basion, porions and orbitales are estimated from the extents of the skull; "
      "--landmarks gives better ones");
  return result;
}

VaultPatient scaphocephalic_patient(const Progress& progress) {
  HeadChoice choice;
  choice.variant = HeadChoice::Variant::scaphocephaly;
  return {builtin_patient(choice, progress), {}};
}

void add_sizes(OperationOutput& output, const Plan& plan, const Operated& operated,
               double whole_mm3) {
  double pieces = 0, kerf = 0;
  for (const BoneSummary& bone : operated_bones(operated)) pieces += bone.volume_mm3;
  for (const CutReport& cut : operated.cuts) kerf += cut.kerf_volume_mm3;
  const ClinicalFrame frame = clinical_frame(operated.patient.landmarks, plan.reference);
  const VaultSize before = vault_size(operated, frame, false),
                  after = vault_size(operated, frame, true);
  const auto json = [](const VaultSize& size) {
    return nlohmann::ordered_json{{"length_mm", size.length_mm},
                                  {"breadth_mm", size.breadth_mm},
                                  {"cephalic_index", size.cephalic_index()}};
  };
  output.json["vault"] = {{"before", json(before)},
                          {"after", json(after)},
                          {"bone_volume_before_mm3", whole_mm3},
                          {"bone_volume_after_mm3", pieces},
                          {"kerf_volume_mm3", kerf}};
  const auto mm = [](double value) { return fmt::format("{:.1f} mm", value); };
  const auto index = [](const VaultSize& size) {
    return fmt::format("{:.1f}", size.cephalic_index());
  };
  const auto cm3 = [](double value) { return fmt::format("{:.2f} cm³", value / 1000); };
  output.add_table("The vault",
                   {{"", "Before", "After"},
                    {{"Greatest length", mm(before.length_mm), mm(after.length_mm)},
                     {"Greatest breadth", mm(before.breadth_mm), mm(after.breadth_mm)},
                     {"Cephalic index", index(before), index(after)},
                     {"Volume of the bone", cm3(whole_mm3), cm3(pieces)},
                     {"Volume of the saw cuts", "", cm3(kerf)}}},
                   "Length and breadth of the bone more than 20 mm above the Frankfort plane. "
                   "A cephalic index below 75 is dolichocephalic.");
}

}  // namespace

int run_vault(const DemoOptions& options, const CommonOptions& common) {
  ProgressBar bar(common);
  const bool delivered = !options.skull.empty();
  auto [patient, notes] =
      delivered ? delivered_skull(options) : scaphocephalic_patient(bar.callback());
  Plan plan = begin_plan(patient, "vault");
  plan = with_cut(patient, std::move(plan),
                  {.osteotomy = "vault_panels",
                   .parameters = {{"columns", 2}, {"height_mm", 88}},
                   .kerf_mm = 1.2});
  plan = with_move(std::move(plan), "strip", {"down", "5"});
  for (const std::string side : {"left", "right"})
    for (const std::string column : {"_1", "_2"})
      plan = with_move(std::move(plan), "panel_" + side + column, {side, "9", "down", "2"});
  const Operated operated = apply_plan(patient, plan);
  OperationOutput output(
      options.out, "Craniosynostosis: the vault reshaped",
      std::string(delivered ? "A delivered skull: the vault"
                            : "A long, narrow skull (scaphocephaly): the vault") +
          " is cut into a sagittal strip and two parietal panels on each side, which share their "
          "saw cuts. The panels are moved outward and the strip down, so that the vault becomes "
          "broader.");
  output.add_operation(plan, operated, bar.callback(), {}, {"above", "back", "left"});
  for (const std::string& note : notes) output.add_note(note);
  double whole = 0;
  for (const CutReport& cut : operated.cuts) whole += cut.volume_mm3;
  add_sizes(output, plan, operated, whole);
  bar.clear();
  if (common.json) fmt::print("{}\n", output.json.dump(2));
  output.finish(common.prints_summary());
  return 0;
}

}  // namespace condyle
