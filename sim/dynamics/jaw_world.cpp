#include "sim/dynamics/jaw_world.h"

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"
#include "sim/motion/condylar_path.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double bone_kg_mm3 = 1.9e-6;
constexpr double box_share = 0.12;  // of its box that a mandible fills
constexpr double least_forward_mm = -0.5, guide_step_mm = 0.5;

Vector3d landmark(const Case& patient, const char* name) {
  const auto point = patient.landmarks.find(name);
  if (!point)
    throw InputError(patient.name + ": the landmark " + name +
                     " is missing; the jaw cannot be hung without it");
  return *point;
}

const Part& part(const Case& patient, Role role, const char* name) {
  const Part* found = patient.find(role);
  if (!found || found->mesh.empty())
    throw InputError(patient.name + ": " + name + " are missing; the jaw cannot close without");
  return *found;
}

/// Of a mandible whose surface is open: of a box that weighs as much as a mandible of its size.
MassProperties mandible_mass(const TriMesh& mesh) {
  const Topology topology = inspect(mesh);
  if (topology.closed() && topology.volume_mm3 > 0) return mass_properties(mesh, bone_kg_mm3);
  const Box box = bounding_box(mesh);
  const Vector3d size = box.size(), square = size.cwiseProduct(size);
  MassProperties out;
  out.mass_kg = box_share * bone_kg_mm3 * size.prod();
  out.center = box.center();
  out.inertia =
      (out.mass_kg / 12 *
       Vector3d(square.y() + square.z(), square.z() + square.x(), square.x() + square.y()))
          .asDiagonal();
  return out;
}

}  // namespace

JawWorld make_jaw_world(const Case& patient, const JawWorldSettings& settings, int threads) {
  const Vector3d condyles[2] = {landmark(patient, "left_condyle"),
                                landmark(patient, "right_condyle")};
  const Vector3d incisor = landmark(patient, "lower_incisal_point");
  const TriMesh &upper = part(patient, Role::upper_teeth, "upper teeth").mesh,
                &lower = part(patient, Role::lower_teeth, "lower teeth").mesh;

  RigidSettings world_settings;
  JawWorld jaw{RigidWorld(world_settings)};
  RigidBody cranium;
  cranium.surfaces = {std::make_shared<const SlideBody>(make_slide_body(upper, {}, threads))};
  const int fixed = jaw.world.add_body(cranium);

  RigidBody mandible;
  mandible.mass = mandible_mass(part(patient, Role::mandible, "mandibles").mesh);
  mandible.X_WB = settings.X_CM;
  mandible.surfaces = {std::make_shared<const SlideBody>(make_slide_body(lower, {}, threads))};
  const double per_step = settings.lost_in_step / world_settings.step_s / 1000;
  mandible.drag_N_s_mm = per_step * mandible.mass.mass_kg;
  mandible.turning_drag_N_mm_s = per_step * least_moment(mandible.mass);
  jaw.mandible = jaw.world.add_body(mandible);
  jaw.world.add_pair({.a = fixed, .b = jaw.mandible, .friction = settings.friction});

  const Pchip path = patient.condylar_path ? known_path(*patient.condylar_path) : average_path();
  for (const Vector3d& condyle : condyles) {
    RigidJoint guide{.kind = RigidJoint::Kind::guide, .a = fixed, .b = jaw.mandible};
    guide.p_B = condyle;
    for (double forward = least_forward_mm; forward <= longest_forward_mm; forward += guide_step_mm)
      guide.curve_A.push_back(condyle - Vector3d(0, forward, path(std::max(forward, 0.0))));
    guide.sideways_A = Vector3d::UnitX();
    jaw.world.add_joint(guide);
  }
  const Vector3d middle = 0.5 * (condyles[0] + condyles[1]);
  jaw.bite_force = jaw.world.add_force({.body = jaw.mandible,
                                        .point = middle + settings.bite_place * (incisor - middle),
                                        .force_N = settings.bite_force_N});
  return jaw;
}

}  // namespace condyle
