#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include "engine/collide/shells.h"

namespace condyle {

/// A triangle with precomputed data for many distance queries.
struct FieldFace {
  Eigen::Vector3d a, ab, ac, normal;  // normal: its length is twice the area
  double bb = 0, bc = 0, cc = 0;      // products of ab and ac
  int shell = 0, triangle = 0;        // in that shell
  std::uint8_t rim = 0;               // see Shell
};

/// The triangle of a shell, whose index among the shells is given.
FieldFace field_face(const Shell& shell, int shell_index, int triangle);

/// Square distance, and the barycentric coordinates of the nearest point: exactly 0 on edges and
/// corners.
double nearest(const FieldFace& face, const Eigen::Vector3d& p, Eigen::Vector3d& at);

/// Whether the point with these barycentric coordinates lies on a rim.
bool on_rim(const FieldFace& face, const Eigen::Vector3d& at);

/// Distances to a triangle in single precision, at a tenth of the cost; they select the triangles
/// that need an exact query.
class FacePlanes {
 public:
  using Four = Eigen::Array4f;

  /// `center`: near all query points; single precision is accurate only there.
  FacePlanes(const FieldFace& face, const Eigen::Vector3d& center);

  /// Squared distances of four points, given relative to the centre; 0 for slivers, which have no
  /// reliable normal.
  Four square_distances(const Four& x, const Four& y, const Four& z) const {
    const auto at = [&](const Eigen::Matrix4f& rows, int k) -> Four {
      return rows(k, 0) * x + rows(k, 1) * y + rows(k, 2) * z + rows(k, 3);
    };
    const Four up = at(out_, 0);
    Four farthest_out = Four::Zero(), in_plane = Four::Constant(1e30f);
    for (int k = 1; k < 4; ++k) {
      const Four out = at(out_, k), along = at(along_, k);
      const Four past = (along - length_[k]).max(-along).max(0);
      farthest_out = farthest_out.max(out);
      in_plane = in_plane.min(out * out + past * past);
    }
    // Above the face no edge counts; outside, the squared distance to an edge's line is a lower
    // bound.
    const Four counts = (farthest_out > 0).select(in_plane, Four::Zero());
    return up * up + counts;
  }

 private:
  Eigen::Matrix4f out_;    // one row each: height above the face, distance outside its three edges
  Eigen::Matrix4f along_;  // position along the edges from their first corners; row 0 is unused
  Four length_;            // of the edges; the first is unused
};

}  // namespace condyle
