#pragma once

#include <memory>

#include "engine/collide/slide.h"
#include "tests/support/boxes.h"

namespace condyle::test {

inline std::shared_ptr<const ContactSurface> body(const TriMesh& mesh) {
  return std::make_shared<const ContactSurface>(make_contact_surface(mesh, {}, 2));
}

/// A flat plate whose top is the plane z = 0.
inline TriMesh plate(double thickness = 4) { return box({-20, -12, -thickness}, {20, 12, 0}); }

}  // namespace condyle::test
