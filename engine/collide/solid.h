#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/math/pose.h"
#include "engine/mesh/measure.h"
#include "engine/mesh/tri_mesh.h"
#include "engine/mesh/triangle_tree.h"

namespace condyle {

struct OverlapDepth;

/// The inside of a surface: the union of its closed shells (connected pieces). Open shells have no
/// inside; closed shells that face inward within another one are cavities and are passed over;
/// other closed shells that face inward are turned. Body coordinates, moved by the pose alone.
class Solid {
 public:
  /// Welded mesh with at least one triangle.
  explicit Solid(const TriMesh& mesh);

  int shell_count() const { return shell_count_; }
  int open_shell_count() const { return open_shell_count_; }

  /// Ball around all vertices.
  const Eigen::Vector3d& center() const { return balls_.front().center; }
  double radius() const { return balls_.front().radius; }

  /// Signed distance to the union, negative inside: exact outside, a lower bound of the depth
  /// inside where shells overlap. Infinite when no shell is closed.
  double signed_distance(const Eigen::Vector3d& p) const;

 private:
  struct Shell {
    TriangleTree tree;
    Box box;
  };
  struct Ball {  // of a run of vertices
    Eigen::Vector3d center;
    double radius = 0;
    int first = 0, count = 0;
    int right = 0;  // second child (the first is next); 0 for a leaf
  };
  struct Deepest {
    double depth_mm = 0;
    Eigen::Vector3d vertex = Eigen::Vector3d::Zero();    // coordinates of the shell
    Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();  // of the shell's surface next to it
  };

  int build_balls(std::vector<Eigen::Vector3d>& points, int first, int last);
  void search(const Shell& shell, const Pose& X, int ball, double center_depth,
              Deepest& best) const;
  static double depth_in(const Shell& shell, const Eigen::Vector3d& p, double radius, double reach);

  void deepest_inside(const Solid& other, const Pose& X_OS, Deepest& best) const;
  bool has_shell_inside(const Solid& other, const Pose& X_OS) const;

  friend OverlapDepth overlap_depth(const Solid& a, const Pose& X_WA, const Solid& b,
                                    const Pose& X_WB);
  friend bool one_encloses_other(const Solid& a, const Pose& X_WA, const Solid& b,
                                 const Pose& X_WB);

  std::vector<Shell> shells_;             // closed, facing outward
  std::vector<Eigen::Vector3d> samples_;  // a vertex of each shell, open ones included
  std::vector<Eigen::Vector3d> points_;   // vertices in the order of the balls
  std::vector<Ball> balls_;               // depth first
  int shell_count_ = 0, open_shell_count_ = 0;
};

/// The deepest vertex of either solid inside the other.
struct OverlapDepth {
  double depth_mm = 0;  // distance to the other's surface; 0 when no vertex is inside
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    // that vertex, world
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit, from A to B
};

/// Depth of overlap, looked for by branch and bound over balls of vertices.
OverlapDepth overlap_depth(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB);

/// For solids whose surfaces do not cross: a shell of one lies wholly inside the other.
bool one_encloses_other(const Solid& a, const Pose& X_WA, const Solid& b, const Pose& X_WB);

}  // namespace condyle
