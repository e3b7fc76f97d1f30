#pragma once

#include <vector>

#include "engine/tissue/mesh_point.h"
#include "engine/tissue/mesh_surface.h"

namespace condyle {

struct ContactSource;

/// Points of one part of the tissue's surface, which must not penetrate another part, and that
/// part's own surface.
struct Flap {
  std::vector<MeshPoint> points;
  std::vector<double> allowance;  // mm, of each: allowed depth
  MeshSurface surface;
};

/// Skin that comes to lie on skin as the jaw opens, from below the chin to the angles of the jaw:
/// the skin that moves with the mandible, and that of the throat. Where the skin bends between the
/// two it may fold.
struct SkinFold {
  Flap chin, throat;
};
SkinFold find_fold(const ContactSource& from);

}  // namespace condyle
