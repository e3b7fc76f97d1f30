#include "sim/dynamics/body_mass.h"

#include "engine/core/error.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

constexpr double bone_kg_mm3 = 1.9e-6;
constexpr double box_fraction = 0.12;  // of its bounding box that a mandible fills

MassProperties part_mass(const TriMesh& mesh) {
  const Topology topology = inspect(mesh);
  if (topology.closed() && topology.volume_mm3 > 0) return mass_properties(mesh, bone_kg_mm3);
  const Box box = bounding_box(mesh);
  const Vector3d size = box.size(), square = size.cwiseProduct(size);
  MassProperties out;
  out.mass_kg = box_fraction * bone_kg_mm3 * size.prod();
  out.center = box.center();
  out.inertia =
      (out.mass_kg / 12 *
       Vector3d(square.y() + square.z(), square.z() + square.x(), square.x() + square.y()))
          .asDiagonal();
  return out;
}

}  // namespace

MassProperties body_mass(const Case& patient, BodyId body) {
  if (patient.mechanics && body == patient.jaw.lower_arch)
    return {patient.mechanics->mandible.mass_kg, patient.mechanics->mandible.center,
            patient.mechanics->mandible.inertia};
  for (const bool crowns : {false, true}) {
    std::optional<MassProperties> sum;
    for (const Part& part : patient.parts) {
      if (part.body != body || !collides(part.role) || part.mesh.empty()) continue;
      if (is_teeth(part.role) != crowns) continue;
      const MassProperties mass = part_mass(part.mesh);
      sum = sum ? joined(*sum, mass) : mass;
    }
    if (sum) return *sum;
  }
  throw InputError(patient.name + ": body " + patient.bodies[body].name +
                   " has no bone, so its mass is unknown");
}

}  // namespace condyle
