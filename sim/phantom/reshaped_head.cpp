#include "sim/phantom/head_warp.h"
#include "sim/phantom/phantom.h"
#include "sim/phantom/shifted_bite.h"
#include "sim/phantom/surfaces.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

/// Which of the warp's three maps moves a part.
Role warp_role(Role role) {
  switch (role) {
    case Role::mandible:
    case Role::lower_teeth:
    case Role::lower_gums:
    case Role::tongue:
      return Role::mandible;
    case Role::face:
      return Role::face;
    default:
      return Role::skull;
  }
}

}  // namespace

Case reshaped_head(Case patient, const HeadChoice& choice) {
  if (choice.is_default()) return patient;
  const HeadShape shape = head_shape(choice);
  const HeadWarp warp(shape, shifted_bite(patient, shape.bite_forward));
  const auto move = [&](Vector3d& p, Role role) {
    p = role == Role::face       ? warp.skin(p)
        : role == Role::mandible ? warp.mandible(p)
                                 : warp.skull(p);
  };
  for (auto& part : patient.parts)
    for (auto& p : part.mesh.vertices) move(p, warp_role(part.role));
  for (auto& [name, point] : patient.landmarks.points) move(point, landmark_role(name));
  for (auto& canal : patient.canals)
    for (auto& p : canal.points) move(p, Role::mandible);
  patient.name = head_name(choice);
  return patient;
}

}  // namespace condyle
