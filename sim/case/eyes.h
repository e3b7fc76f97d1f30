#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "engine/mesh/tri_mesh.h"
#include "sim/case/landmarks.h"

namespace condyle {

/// Where one eye lies, in the cranium's frame, mm.
struct Eye {
  Eigen::Vector3d inner = Eigen::Vector3d::Zero(), outer = Eigen::Vector3d::Zero();  // its canthi
  Eigen::Vector3d globe = Eigen::Vector3d::Zero();  // centre of the eyeball

  /// Distance of a point from the line between the canthi, seen from the front.
  double distance(const Eigen::Vector3d& p) const;
};

struct Eyes {
  Eye left, right;
  double height() const { return 0.25 * (left.inner + left.outer + right.inner + right.outer).z(); }
};

/// By the landmarks endocanthion, exocanthion and eyeball of both sides; those missing follow from
/// the openings of the face. Null without landmarks and openings.
std::optional<Eyes> find_eyes(const TriMesh& face, const Landmarks& landmarks);

}  // namespace condyle
