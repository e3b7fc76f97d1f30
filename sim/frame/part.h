#pragma once

#include <string>
#include <vector>

#include "engine/mesh/tri_mesh.h"
#include "sim/frame/body_tree.h"

namespace condyle {

/// The role of a surface. Eyes, gums and tongue are only drawn.
enum class Role {
  skull,
  maxilla,
  mandible,
  upper_teeth,
  lower_teeth,
  face,
  eyes,
  upper_gums,
  lower_gums,
  tongue,
  segment,    // a piece of bone that was cut free
  transplant  // bone from elsewhere, or an implant
};

/// The default body of a surface at import: the mandible for lower ones, else the cranium. A piece
/// (see below) gets its own body instead.
constexpr BodyId default_body(Role role) {
  switch (role) {
    case Role::mandible:
    case Role::lower_teeth:
    case Role::lower_gums:
    case Role::tongue:
      return mandible_body;
    default:
      return cranium_body;
  }
}

/// Bone that becomes its own body at import.
constexpr bool is_piece(Role role) { return role == Role::segment || role == Role::transplant; }

constexpr bool is_teeth(Role role) {
  return role == Role::upper_teeth || role == Role::lower_teeth;
}

/// The face deforms with the soft tissue; every other surface is rigid.
constexpr bool is_rigid(Role role) { return role != Role::face; }

/// Bone and teeth take part in collision.
constexpr bool collides(Role role) {
  return role == Role::skull || role == Role::maxilla || role == Role::mandible || is_teeth(role) ||
         is_piece(role);
}

/// One separate tooth of an arch: its FDI number and its range of triangles in the part's mesh.
struct Tooth {
  int fdi = 0;
  int first_triangle = 0;
  int triangle_count = 0;
};

/// A named surface of the patient at rest, in the cranium's frame.
struct Part {
  std::string name;  // unique in the case, e.g. "mandible"
  Role role = Role::skull;
  TriMesh mesh;
  std::vector<Tooth> teeth;          // of dental arches with separate crowns
  BodyId body = default_body(role);  // the rigid body that carries it
};

}  // namespace condyle
