#pragma once

#include <memory>
#include <vector>

#include "sim/case/case.h"
#include "sim/frame/body_poses.h"

namespace condyle {

struct DistanceMapSettings {
  double reach_mm = 2;  // distances and depths beyond are infinite
  // Triangles are subdivided to this size where surfaces may touch, so that a map is smooth between
  // vertices.
  double teeth_edge_mm = 1.0;
  double bone_edge_mm = 2.0;
  int max_triangles = 150000;  // of one part
  // In addition to the case's own; the last match applies.
  std::vector<PairRule> pair_rules = {};
};

/// Whether a surface that can collide is open, so that it has no inside.
bool has_open_surfaces(const Case& patient);

/// Distance of each bone and each arch to all parts that it may touch: from parts fixed to the
/// cranium to those of the mandible and free parts, and so on. Excluded are pairs of one body, and
/// those that were one before a cut.
class DistanceMap {
 public:
  /// `patient` may be destroyed afterwards.
  explicit DistanceMap(const Case& patient, const DistanceMapSettings& settings = {},
                       int threads = 1);
  ~DistanceMap();
  DistanceMap(DistanceMap&&) noexcept;
  DistanceMap& operator=(DistanceMap&&) noexcept;

  /// A part's surface in the map: the same surface, in smaller triangles.
  struct Surface {
    int part = 0;                          // index in the case
    TriMesh mesh;                          // its first vertices are the part's own
    std::vector<Eigen::Vector3f> normals;  // unit, as smooth as on the part itself
    bool unsigned_near_open = false;       // something it may meet has open shells, which have no
                                           // inside: near them distance has no sign
  };
  /// Surfaces of parts that may touch another, in the case's order.
  const std::vector<Surface>& surfaces() const;

  /// One value per vertex of each surface, mm: exact signed distance within the reach, negative
  /// inside; +infinity farther off, -infinity deeper. Depends on the poses alone; bit-identical for
  /// any number of threads.
  using Values = std::vector<std::vector<float>>;
  Values at(const BodyPoses& poses, int threads = 1) const;

  double reach_mm() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace condyle
