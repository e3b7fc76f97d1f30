#pragma once

#include "sim/operation/operation.h"
#include "tests/sim/plan/marks.h"
#include "tests/support/boxes.h"

namespace condyle::test {

/// Six teeth of an arch, 6 mm apart, as boxes; the first three on the left.
inline Part box_arch(const char* name, Role role, int quadrant_left, int quadrant_right, double low,
                     double high) {
  Part part;
  part.name = name;
  part.role = role;
  part.body = default_body(role);
  for (int i = 0; i < 6; ++i) {
    const bool left = i < 3;
    const double x = (left ? 1 : -1) * (3.0 + 6.0 * (i % 3));
    const TriMesh tooth = box({x - 2, -90, low}, {x + 2, -84, high});
    const int offset = static_cast<int>(part.mesh.vertices.size());
    part.teeth.push_back({10 * (left ? quadrant_left : quadrant_right) + 1 + i % 3,
                          static_cast<int>(part.mesh.triangles.size()), 12});
    for (const auto& v : tooth.vertices) part.mesh.vertices.push_back(v);
    for (const auto& t : tooth.triangles)
      part.mesh.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
  }
  return part;
}

/// A skull and a mandible of boxes, with teeth in them, gums and a canal.
inline Case operable_patient() {
  Case patient;
  patient.name = "boxes";
  patient.landmarks = upright_marks();
  const auto add = [&](const char* name, Role role, const TriMesh& mesh) {
    patient.parts.push_back({name, role, mesh, {}});
  };
  add("skull", Role::skull, box({-60, -92, -30}, {60, 80, 60}));
  add("mandible", Role::mandible, box({-50, -92, -80}, {50, 0, -41}));
  patient.parts.push_back(box_arch("upper_teeth", Role::upper_teeth, 2, 1, -37, -20));
  patient.parts.push_back(box_arch("lower_teeth", Role::lower_teeth, 3, 4, -52, -37.5));
  add("lower_gums", Role::lower_gums, box({-20, -93, -42}, {20, -80, -39}));
  auto& points = patient.landmarks.points;
  points["upper_incisal_point"] = {0, -90, -37};
  points["lower_incisal_point"] = {0, -90, -37.5};
  points["left_condyle"] = {48, -5, -45};
  points["right_condyle"] = {-48, -5, -45};
  points["pogonion"] = {0, -92, -75};
  points["left_mental_foramen"] = {50, -60, -60};
  patient.canals = {{"left_mandibular_canal", mandible_body, 3, {{40, -5, -50}, {40, -60, -60}}}};
  return patient;
}

/// A disc wide enough for all of these bones.
inline PlanePatch disc(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                       double radius = 200) {
  return {.point = point, .normal = normal, .reach = radius};
}

inline CutStep plane_cut(const char* target, const PlanePatch& patch,
                         std::vector<std::string> pieces, double kerf_mm = 0) {
  CutStep step;
  step.target = target;
  step.surfaces = {patch};
  step.kerf_mm = kerf_mm;
  step.pieces = std::move(pieces);
  return step;
}

/// The first piece is the one that the normal points to.
inline CutStep chin_step(const char* target = "mandible") {
  return plane_cut(target, disc({0, -92, -70}, {0, 0, -1}), {"chin"}, 0.5);
}
inline CutStep maxilla_step() {
  return plane_cut("cranium", disc({0, -92, -10}, {0, 0, -1}), {"maxilla"}, 1);
}
/// Behind this plane both condyles are one segment.
inline CutStep ramus_step(std::vector<std::string> pieces) {
  return plane_cut("mandible", disc({0, -30, -60}, {0, 1, 0}), std::move(pieces));
}

inline Plan plan_of(const Case& patient, const std::vector<PlanAction>& actions) {
  Plan plan;
  plan.name = "test";
  plan.geometry = geometry_of(patient);
  for (const PlanAction& action : actions) plan = with_step(std::move(plan), action);
  return plan;
}

inline const Part* part_named(const Case& patient, const std::string& name) {
  for (const Part& part : patient.parts)
    if (part.name == name) return &part;
  return nullptr;
}

/// The name of the body of a part; empty without the part.
inline std::string body_of(const Case& patient, const std::string& part) {
  const Part* found = part_named(patient, part);
  return found ? patient.bodies[found->body].name : "";
}
inline std::string parent_of(const Case& patient, const std::string& body) {
  const auto found = patient.bodies.find(body);
  return found ? patient.bodies[patient.bodies[*found].parent].name : "";
}

}  // namespace condyle::test
