#pragma once

#include <Eigen/Core>

#include "engine/collide/collision_mesh.h"
#include "engine/collide/solid.h"
#include "engine/math/pose.h"

namespace condyle {

/// A body for intersection and enclosure tests; both members are of the same mesh.
struct DepenetrationBody {
  const CollisionMesh& surface;
  const Solid& solid;
};

/// A short translation that separates two overlapping bodies.
struct Depenetration {
  enum class Status {
    apart,   // the bodies neither intersect nor enclose each other
    found,   // this translation separates them
    unknown  // a surface has open shells: its inside is undefined
  } status = Status::unknown;
  double length_mm = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // of the translation of B, world, unit
};

struct DepenetrationSettings {
  int directions = 96;  // directions tried over the sphere; the best is then refined
  double precision_mm =
      0.01;  // the bodies overlap along the whole translation except for at most this length
};

/// The shortest translation found that separates B from A; the separation is verified. It is not
/// always the global minimum: straight translations in the directions tried.
Depenetration push_out(const DepenetrationBody& a, const Pose& X_WA, const DepenetrationBody& b,
                       const Pose& X_WB, const DepenetrationSettings& settings = {});

}  // namespace condyle
