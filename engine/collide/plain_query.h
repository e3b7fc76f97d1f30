#pragma once

#include <memory>

#include "engine/math/pose.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A surface for FCL's own queries, without a warm start: the baseline of the benchmarks. Its
/// contacts and distances are not reliable (see distance() of collision_mesh.h).
class PlainSurface {
 public:
  /// throws: InputError, see require_sound.
  explicit PlainSurface(const TriMesh& mesh);
  ~PlainSurface();

  struct Tree;
  const Tree& tree() const { return *tree_; }

 private:
  std::unique_ptr<const Tree> tree_;
};

struct PlainQuery {
  int contacts = 0;  // crossing triangles found, up to `max_contacts`
  double distance_mm = 0;
};
PlainQuery plain_query(const PlainSurface& a, const Pose& X_WA, const PlainSurface& b,
                       const Pose& X_WB, int max_contacts);

}  // namespace condyle
