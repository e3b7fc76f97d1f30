#pragma once

#include "sim/plan/plan.h"
#include "tests/sim/plan/marks.h"

namespace condyle::test {

/// A case of a few boxes.
inline Case box_patient() {
  Case patient;
  patient.name = "boxes";
  for (const auto& [name, role] : std::vector<std::pair<std::string, Role>>{
           {"skull", Role::skull}, {"mandible", Role::mandible}, {"eyes", Role::eyes}}) {
    Part part;
    part.name = name;
    part.role = role;
    part.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1.0 + name.size()}};
    part.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    part.body = default_body(role);
    patient.parts.push_back(std::move(part));
  }
  patient.landmarks = upright_marks();
  return patient;
}

inline CutStep le_fort() {
  return {.osteotomy = "le_fort_1",
          .target = "cranium",
          .parameters = {{"height_mm", 5.1}, {"tilt_deg", -3}},
          .kerf_mm = 0.7,
          .pieces = {"maxilla"}};
}

inline CutStep chin_cut() {
  BentSheet sheet{.polyline = {{-30, -60, -75}, {0, -80, -72.5}, {30, -60, -75}},
                  .direction = {0, 1, 0.1},
                  .depth_mm = 40};
  PlanePatch disc{.point = {1, 2, 3}, .normal = {0, 0, 2}, .reach = 12.5};
  PlanePatch rectangle{
      .point = {1, 2, 3}, .normal = {0, 0.6, 0.8}, .reach = PatchRectangle{{1, 0, 0}, 20, 8}};
  return {.target = "mandible",
          .surfaces = {sheet, disc, rectangle},
          .pieces = {"mandible rest", "chin"}};
}

/// Steps 1 to 5: cut, move, cut, explicit move, note.
inline Plan sample_plan() {
  Plan plan{.name = "class III \"first\"", .geometry = geometry_of(box_patient())};
  plan = with_step(plan, le_fort());
  plan = with_step(plan, MoveStep{"maxilla", ClinicalMove{.forward_mm = 4, .up_mm = 2}});
  plan = with_step(plan, chin_cut());
  const Eigen::Quaterniond R(Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 2, 3).normalized()));
  plan = with_step(plan, MoveStep{"chin", ExplicitMove{{R, {0.1, -1.0 / 3, 1e-17}}}});
  return with_step(plan, NoteStep{"teeth 18, 28\nout; bögen"});
}

}  // namespace condyle::test
