#pragma once

#include <Eigen/Core>

#include "engine/collide/collision_mesh.h"
#include "engine/collide/solid.h"
#include "engine/math/pose.h"

namespace condyle {

/// A body as crossing and enclosure see it; both of the same mesh.
struct PushBody {
  const CollisionMesh& surface;
  const Solid& solid;
};

/// A short way out for a body that lies in another.
struct PushOut {
  enum class Status {
    apart,   // they neither cross nor does one enclose the other
    found,   // moved so, they are apart
    unknown  // one has open shells: what is inside cannot be told
  } status = Status::unknown;
  double length_mm = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // in which to move B, world, unit
};

struct PushOutSettings {
  int directions = 96;         // tried all around; the best is then refined
  double precision_mm = 0.01;  // on the whole way but the last of this length they overlap
};

/// The shortest translation of B found that parts the two: checked to part them. Not always the
/// shortest there is: straight ways in the directions tried.
PushOut push_out(const PushBody& a, const Pose& X_WA, const PushBody& b, const Pose& X_WB,
                 const PushOutSettings& settings = {});

}  // namespace condyle
