#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "engine/math/pose.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/tri_mesh.h"

namespace condyle {

struct PairCache;

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
  double overlap_mm = 0;  // length of the shortest translation that separates the two triangles
  TrianglePair triangles;
};

/// A surface with its tree of boxes (BoxTree) in body coordinates: built once, moved
/// by its pose alone. Queries are const and thread-safe.
class CollisionMesh {
 public:
  /// throws: InputError, see require_sound.
  explicit CollisionMesh(const TriMesh& mesh) : CollisionMesh(mesh, {}) {}
  /// The same with the tree kept in a cache folder, for surfaces of a patient's files.
  CollisionMesh(const TriMesh& mesh, const std::filesystem::path& cache);
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

/// Minimum distance, to rounding (about 1e-13 mm). `start`: the triangles of an earlier answer; any
/// valid pair gives the same answer, a near one faster. `cache`: of these two surfaces; it makes a
/// query near the pose of the last one faster, and may be null.
MeshDistance distance(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b,
                      const Pose& X_WB, TrianglePair start = {}, PairCache* cache = nullptr);

/// The distance where it is below `reach_mm`; nothing otherwise, which is decided much faster.
std::optional<MeshDistance> distance_within(double reach_mm, const CollisionMesh& a,
                                            const Pose& X_WA, const CollisionMesh& b,
                                            const Pose& X_WB, TrianglePair start = {},
                                            PairCache* cache = nullptr);

/// Distance of two triangles of the surfaces; infinite where they have no such triangles.
double triangle_gap(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b,
                    const Pose& X_WB, TrianglePair triangles);

/// distance(...) == 0, without the distance.
bool touching(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b, const Pose& X_WB,
              TrianglePair start = {});

/// The path of a body to its present pose, at constant speed: a pivot moves along a straight line
/// and the body rotates about it. All in body coordinates at the present pose.
struct BodyPath {
  Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // of the pivot, mm
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();   // axis times angle, rad

  /// Upper bound of the distance between any position on the path and the present position, of all
  /// points within `radius` of p.
  double length(const Eigen::Vector3d& p, double radius = 0) const {
    const double angle = turn.norm();
    // Length of the rotation along its arc, and the deviation of the arc from its chord.
    const Eigen::Vector3d along = turn.cross(p - pivot);
    return (shift + along).norm() + angle * (0.5 * along.norm() + radius * (1 + 0.5 * angle));
  }
};

/// Whether the moving surface kept a distance of at least `min_distance_mm` along its whole path to
/// X_WM. The test is conservative and uses the final pose: each part must be farther away than its
/// own path is long. False means undecided. `start`: triangles of the fixed and of the moving
/// surface that are tested first.
bool clear_on_path(const CollisionMesh& stays, const Pose& X_WS, const CollisionMesh& moves,
                   const Pose& X_WM, const BodyPath& path, double min_distance_mm,
                   TrianglePair start = {});

/// Deep overlap gives very many crossing triangles; a report needs a limited number, spread over
/// the surface.
struct ContactLimits {
  int total = 4096;
  int per_region = 4096;  // in each of up to 64 regions of the surface of A
};

/// Pairs of crossing triangles, in the tree's order, up to the limits. `cache`: see distance; of no
/// use where regions have a limit of their own.
std::vector<MeshContact> contacts(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b,
                                  const Pose& X_WB, ContactLimits limits = {},
                                  PairCache* cache = nullptr);

/// Length of the shortest translation that separates the two triangles of a contact, mm.
double overlap(const CollisionMesh& a, const Pose& X_WA, const CollisionMesh& b, const Pose& X_WB,
               TrianglePair triangles);

}  // namespace condyle
