#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include "engine/collide/shells.h"

namespace condyle {

/// A triangle made ready for many distance queries.
struct FieldFace {
  Eigen::Vector3d a, ab, ac, normal;  // normal: of twice the area's length
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

/// Distances to a triangle in single precision, at a tenth of the cost: they tell which triangles
/// need a closer look.
class FacePlanes {
 public:
  using Four = Eigen::Array4f;

  /// `center`: near all points to be asked for, as single precision serves only there.
  FacePlanes(const FieldFace& face, const Eigen::Vector3d& center);

  /// Square distances of four points less the center; 0 for slivers, which have no certain normal.
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
    // Over the face no side counts; outside, the square of the way out is below the side's.
    const Four counts = (farthest_out > 0).select(in_plane, Four::Zero());
    return up * up + counts;
  }

 private:
  Eigen::Matrix4f out_;    // a row each: height over the face, way out of its three sides
  Eigen::Matrix4f along_;  // way along the sides from their first corners; row 0 is empty
  Four length_;            // of the sides; the first is empty
};

}  // namespace condyle
