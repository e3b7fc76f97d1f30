#pragma once

#include <memory>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Bullet's own contact of two triangle meshes (GImpact), unmodified: a reference for measurements
/// only.
class BulletMeshPair {
 public:
  BulletMeshPair(const TriMesh& a, const TriMesh& b);
  ~BulletMeshPair();

  /// Contacts found with B at this pose in A; `depth_mm` of the deepest.
  struct Found {
    int contacts = 0;
    double depth_mm = 0;
  };
  Found find(const Pose& X_AB);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
