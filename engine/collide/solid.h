#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "engine/collide/triangle_distance.h"
#include "engine/core/made_once.h"
#include "engine/math/pose.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/tri_mesh.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {

/// The inside of a surface: the union of its closed shells (connected pieces). Open shells have no
/// inside; closed shells that face inward within another one are cavities and are ignored; other
/// closed shells that face inward are flipped. Body coordinates, moved by the pose alone. Queries
/// are thread-safe; trees for depths and distances are made for the first of them.
class Solid {
 public:
  /// Welded mesh. throws: InputError, see require_sound.
  explicit Solid(const TriMesh& mesh);

  /// Without cavities.
  int shell_count() const { return shell_count_; }
  int open_shell_count() const { return open_shell_count_; }

  std::size_t face_count() const { return face_count_; }

  /// Ball around all vertices.
  const Eigen::Vector3d& center() const { return ball_.center; }
  double radius() const { return ball_.radius; }

  /// Largest p . direction over all vertices.
  double extent(const Eigen::Vector3d& direction) const;

  /// Signed distance to the union, negative inside: exact outside, a lower bound of the depth
  /// inside where shells overlap. Infinite when no shell is closed.
  double signed_distance(const Eigen::Vector3d& p) const;

 private:
  friend class DepthSearch;
  friend bool one_encloses_other(const Solid& a, const Pose& X_WA, const Solid& b,
                                 const Pose& X_WB);

  struct ClosedShell {
    MadeOnce<TriangleTree, TriMesh> made_tree;
    Box box;

    const TriangleTree& tree() const { return made_tree.get(); }
    /// Depth of p inside, negative outside; -infinity when a ball of `radius` about p cannot reach
    /// it. `reach`: an upper bound of the distance of p from the surface, where known.
    double depth(const Eigen::Vector3d& p, double radius, double reach) const;
  };
  struct Ball {  // bounds a range of faces
    Eigen::Vector3d center;
    double radius = 0;
    int first = 0, count = 0;
    int right = 0;           // second child (the first is next); 0 for a leaf
    bool connected = false;  // its faces are connected at their corners
  };
  /// The triangles of the mesh with a tree of balls.
  struct Faces {
    explicit Faces(const TriMesh& mesh);

    std::vector<Triangle> faces;           // in the order of the balls
    std::vector<int> slot;                 // per triangle of the mesh: its index among the faces
    std::vector<Ball> balls;               // depth first
    std::vector<Eigen::Vector3i> corners;  // of each face
    std::vector<int> first_at, at_corner;  // faces at each corner
    std::vector<int> piece;                // per face; pieces share no corner
    std::vector<int> piece_face;           // one face of each piece

    /// Calls at(face) for each face at a corner of this one, including itself.
    template <class At>
    void each_neighbour(int face, const At& at) const {
      for (const int v : corners[face])
        for (int i = first_at[v]; i < first_at[v + 1]; ++i) at(at_corner[i]);
    }

   private:
    int build_balls(const TriMesh& mesh, std::vector<int>& order, int first, int last);
    void find_connected(const TriMesh& mesh, const std::vector<int>& order);
    void find_neighbours(const TriMesh& mesh);
  };

  /// The ball around a range of faces, and the box of their corners.
  static std::pair<Ball, Box> ball_around(const TriMesh& mesh, const std::vector<int>& order,
                                          int first, int last);
  const Faces& faces() const { return faces_.get(); }
  bool has_shell_inside(const Solid& other, const Pose& X_OS) const;

  std::vector<ClosedShell> shells_;       // facing outward
  std::vector<Eigen::Vector3d> samples_;  // one vertex of each shell, open ones included
  MadeOnce<Faces, TriMesh> faces_;
  Ball ball_ = {};  // around all
  std::size_t face_count_ = 0;
  int shell_count_ = 0, open_shell_count_ = 0;
};

struct DepthSettings {
  // The answer may be too small by this much, or by a thousandth of itself if that is more.
  double tolerance_mm = 2e-4;
  // Limit of points evaluated; the search then ends and `error_mm` bounds the remaining error.
  int max_evaluations = 20000;
};

/// The triangles of each mesh that cross the other mesh: all of them, in any order. A connected
/// part without a crossing lies entirely inside or outside, which saves most evaluations.
struct CrossingFaces {
  std::vector<int> a, b;
};

/// A part of a solid's surface, in the coordinates of the whole solid: its faces, which may have
/// rims, and a tree of the same triangles. Both must outlive the query.
struct SurfacePart {
  const Solid& faces;
  const TriangleTree& tree;
};

/// The deepest point of either surface inside the other solid.
struct OverlapDepth {
  double depth_mm = 0;  // its distance to the surface of that solid; 0 when nothing is inside
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // that point, world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from A to B
  double error_mm = 0;  // no point of the surfaces is deeper than depth_mm + error_mm
};

/// Depth of overlap over the whole surfaces, not only the vertices, by branch and bound. Points of
/// open shells may be inside another solid; open shells themselves have no inside.
OverlapDepth overlap_depth(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                           const DepthSettings& settings = {},
                           const CrossingFaces* crossing = nullptr);

/// The same where only a part of B's surface counts: points of that part inside A, and points of
/// A's surface inside the whole of B to which the part is nearest. `crossing`: of A and the part.
OverlapDepth overlap_depth(const Solid& a, const Pose& X_WA, const Solid& b,
                           const SurfacePart& part_of_b, const Pose& X_WB,
                           const DepthSettings& settings = {},
                           const CrossingFaces* crossing = nullptr);

/// For solids whose surfaces do not cross: whether a shell of one lies entirely inside the other.
bool one_encloses_other(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB);

}  // namespace condyle
