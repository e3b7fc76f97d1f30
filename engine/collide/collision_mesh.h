#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "engine/math/pose.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// A triangle of each surface.
struct TrianglePair {
  int a = -1, b = -1;
};

/// Exact minimum distance of two surfaces, 0 when they cross or touch. Witness points in the world.
struct MeshDistance {
  double distance_mm = 0;
  Eigen::Vector3d witness_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d witness_b = Eigen::Vector3d::Zero();
  TrianglePair triangles;  // of the witness points: the start of the next query
};

/// One pair of crossing triangles.
struct MeshContact {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // middle of the common segment, world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from A to B, of the outward normals
  double overlap_mm = 0;                              // least move that parts the two triangles
  TrianglePair triangles;
};

/// A surface with its tree of boxes (FCL's BVHModel<OBBRSS>), in its body's own coordinates: built
/// once, moved by its pose alone. Queries are const and may run on several threads at once.
class CollisionMesh {
 public:
  /// throws: InputError, see require_sound.
  explicit CollisionMesh(const TriMesh& mesh);
  ~CollisionMesh();
  CollisionMesh(CollisionMesh&&) noexcept;
  CollisionMesh& operator=(CollisionMesh&&) noexcept;

  /// Around all triangles, along the axes of the body's coordinates.
  const Box& box() const { return box_; }

  struct Tree;
  const Tree& tree() const { return *tree_; }

 private:
  std::unique_ptr<Tree> tree_;
  Box box_;
};

/// Minimum distance, to rounding (about 1e-13 mm). `start`: where an earlier answer was; any valid
/// pair gives the same distance, a near one sooner.
MeshDistance distance(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b,
                      const Pose& X_WB, TrianglePair start = {});

/// The same as far as it matters: nothing when the surfaces are `reach_mm` or more apart, which is
/// told much sooner.
std::optional<MeshDistance> distance_within(double reach_mm, const CollisionMesh& a,
                                            const Pose& X_WA, const CollisionMesh& b,
                                            const Pose& X_WB, TrianglePair start = {});

/// distance(...) == 0, without the distance.
bool touching(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b, const Pose& X_WB,
              TrianglePair start = {});

/// A body's way to where it is now, at even speed: a pivot of its own coordinates goes straight,
/// and the body turns about it. All in those coordinates as they are now.
struct BodyWay {
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // of the pivot, mm
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();   // axis times angle, rad

  /// On the way nothing within `radius` of p is farther than this from where it is now.
  double length(const Eigen::Vector3d& p, double radius = 0) const {
    const double angle = turn.norm();
    // What the turn adds up along its arc, and how far the arc bends from that.
    const Eigen::Vector3d along = turn.cross(p - pivot);
    return (shift + along).norm() + angle * (0.5 * along.norm() + radius * (1 + 0.5 * angle));
  }
};

/// Whether the moving surface was at least `kept_mm` from the other one on its whole way to X_WM,
/// told from there: each part of it is farther than its own way is long. False does not tell that
/// it was not. `start`: looked at first; triangles of the one that stays and of the one that moves.
bool clear_on_way(const CollisionMesh& stays, const Pose& X_WS, const CollisionMesh& moves,
                  const Pose& X_WM, const BodyWay& way, double kept_mm, TrianglePair start = {});

/// Crossing triangles are many where bones grind: a report wants some, spread over the surface.
struct ContactLimits {
  int total = 4096;
  int per_region = 4096;  // in each of up to 64 regions of A's surface
};

/// Pairs of crossing triangles, in the tree's order, up to the limits.
std::vector<MeshContact> contacts(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b,
                                  const Pose& X_WB, ContactLimits limits = {});

/// Length of the shortest move that parts the two triangles of a contact, mm.
double overlap(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b, const Pose& X_WB,
               TrianglePair triangles);

/// FCL's own queries as they come, cold, on the same trees: what ours are measured against. Its
/// contacts and distances are not to be relied on (see distance).
struct PlainQuery {
  int contacts = 0;  // crossing triangles found, up to `most_contacts`
  double distance_mm = 0;
};
PlainQuery plain_query(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b,
                       const Pose& X_WB, int most_contacts);

}  // namespace condyle
