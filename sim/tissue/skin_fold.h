#pragma once

#include <vector>

#include "engine/tissue/net_point.h"
#include "engine/tissue/net_surface.h"

namespace condyle {

struct ContactSource;

/// Points of one part of the tissue's surface, which must not enter another part, and that part's
/// own surface.
struct Flap {
  std::vector<NetPoint> points;
  std::vector<double> allowance;  // mm, of each: how deep it may be
  NetSurface surface;
};

/// Skin that comes to lie on skin as the jaw opens, from below the chin to the angles of the jaw:
/// that which goes with the mandible, and that of the throat. Where the skin bends between the two
/// it may do so.
struct SkinFold {
  Flap chin, throat;
};
SkinFold find_fold(const ContactSource& from);

}  // namespace condyle
