#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/collide/triangle_distance.h"
#include "engine/math/pose.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/tri_mesh.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {

/// The inside of a surface: the union of its closed shells (connected pieces). Open shells have no
/// inside; closed shells that face inward within another one are cavities and are passed over;
/// other closed shells that face inward are turned. Body coordinates, moved by the pose alone.
class Solid {
 public:
  /// Welded mesh. throws: InputError, see require_sound.
  explicit Solid(const TriMesh& mesh);

  /// Cavities do not count.
  int shell_count() const { return shell_count_; }
  int open_shell_count() const { return open_shell_count_; }

  std::size_t face_count() const { return faces_.size(); }

  /// Ball around all vertices.
  const Eigen::Vector3d& center() const { return balls_.front().center; }
  double radius() const { return balls_.front().radius; }

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
    TriangleTree tree;
    Box box;

    /// Depth of p inside, negative outside; -infinity when a ball of `radius` about p cannot reach
    /// it. `reach`: no less than the distance of p from the surface, if known.
    double depth(const Eigen::Vector3d& p, double radius, double reach) const;
  };
  struct Ball {  // of a run of faces
    Eigen::Vector3d center;
    double radius = 0;
    int first = 0, count = 0;
    int right = 0;           // second child (the first is next); 0 for a leaf
    bool connected = false;  // its faces hang together at their corners
  };

  void order_faces(const TriMesh& mesh);
  int build_balls(const TriMesh& mesh, std::vector<int>& order, int first, int last);
  void find_connected(const TriMesh& mesh, const std::vector<int>& order);
  void find_neighbours(const TriMesh& mesh);
  /// Calls at(face) for each face at one of this one's corners, this one too.
  template <class At>
  void each_neighbour(int face, const At& at) const {
    for (const int v : face_corners_[face])
      for (int i = first_at_[v]; i < first_at_[v + 1]; ++i) at(at_corner_[i]);
  }
  bool has_shell_inside(const Solid& other, const Pose& X_OS) const;

  std::vector<ClosedShell> shells_;            // facing outward
  std::vector<Eigen::Vector3d> samples_;       // a vertex of each shell, open ones included
  std::vector<Triangle> faces_;                // in the order of the balls
  std::vector<int> slot_;                      // of each of the mesh's triangles, among the faces
  std::vector<Ball> balls_;                    // depth first
  std::vector<Eigen::Vector3i> face_corners_;  // of each face
  std::vector<int> first_at_, at_corner_;      // faces at each corner
  std::vector<int> piece_;                     // of each face; pieces share no corner
  std::vector<int> piece_face_;                // one of each piece
  int shell_count_ = 0, open_shell_count_ = 0;
};

struct DepthSettings {
  // The answer may be this much too small, or a thousandth of itself if that is more.
  double tolerance_mm = 2e-4;
  // Points looked at; beyond, the search ends and `error_mm` tells what may be missing.
  int max_looks = 20000;
};

/// The triangles of each mesh that cross the other mesh: all of them, in any order. What hangs
/// together without crossing anything lies inside or outside as a whole, which spares most looks.
struct CrossingFaces {
  std::vector<int> a, b;
};

/// The deepest point of either surface inside the other solid.
struct OverlapDepth {
  double depth_mm = 0;  // its distance to that solid's surface; 0 when nothing is inside
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // that point, world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from A to B
  double error_mm = 0;  // no point of the surfaces is deeper than depth_mm + error_mm
};

/// Depth of overlap over the whole surfaces, not the vertices alone, by branch and bound. Open
/// shells have points that may be inside, but no inside themselves.
OverlapDepth overlap_depth(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB,
                           const DepthSettings& settings = {},
                           const CrossingFaces* crossing = nullptr);

/// For solids whose surfaces do not cross: a shell of one lies wholly inside the other.
bool one_encloses_other(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB);

}  // namespace condyle
