#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// What a surface is. Eyes, gums and tongue are only drawn.
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

/// What a surface is part of: the fixed cranium C, the mandible M, the deforming soft tissue, or a
/// free body F of its own.
enum class Body { cranium, mandible, tissue, free };

constexpr Body body_of(Role role) {
  switch (role) {
    case Role::mandible:
    case Role::lower_teeth:
    case Role::lower_gums:
    case Role::tongue:
      return Body::mandible;
    case Role::face:
      return Body::tissue;
    case Role::segment:
    case Role::transplant:
      return Body::free;
    default:
      return Body::cranium;
  }
}

constexpr bool is_teeth(Role role) {
  return role == Role::upper_teeth || role == Role::lower_teeth;
}

/// Bone and teeth take part in collision.
constexpr bool collides(Role role) {
  return role == Role::skull || role == Role::maxilla || role == Role::mandible || is_teeth(role) ||
         body_of(role) == Body::free;
}

/// One separate tooth of an arch: its FDI number and its run of triangles in the part's mesh.
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
  std::vector<Tooth> teeth;      // only of teeth whose crowns are separate
  Body carrier = Body::cranium;  // of a free part: the cranium or the mandible, whichever it goes
                                 // along with where it is not moved itself
};

}  // namespace condyle
