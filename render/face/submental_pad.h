#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/made_once.h"
#include "render/mesh/spanning_surface.h"

namespace condyle {

/// Midline of the skin under the chin at rest; points on it, mm.
struct NeckProfile {
  Eigen::Vector3f pogonion;        // foremost point of the chin
  Eigen::Vector3f cervical_point;  // where throat and chin meet
  Eigen::Vector3f chin, throat;    // 30 mm of an adult to either side of it
  float unit;                      // millimetres that stand for one of an adult
};

/// The profile of a face at rest, mm, LPS. rim: of the mouth. None where the midline shows no angle
/// between chin and throat.
std::optional<NeckProfile> find_neck_profile(std::span<const Eigen::Vector3f> rest,
                                             std::span<const Eigen::Vector3i> triangles,
                                             std::span<const int> rim);

/// The pad of skin and fat under the chin, in pictures alone: an opening jaw brings the chin to the
/// throat, and the skin between them bulges instead of folding into a deep cleft. It is drawn on a
/// surface that spans chin and throat, plus what it differs from such a surface at rest, in
/// proportion to the distance of chin and throat. While they keep three quarters of their distance,
/// nothing changes, bit for bit. Deterministic.
class SubmentalPad {
 public:
  /// rest: displayed vertices of the face at rest, mm, LPS. rim: of the mouth. Without a rim or a
  /// profile there is no pad.
  SubmentalPad(std::span<const Eigen::Vector3f> rest, std::span<const Eigen::Vector3i> triangles,
               std::span<const int> rim);

  /// Displaces the current positions, mm.
  void apply(std::vector<Eigen::Vector3f>& places) const;

 private:
  struct Pad {
    int chin, throat;  // vertices whose distance is measured
    float rest_mm;
    std::vector<int> vertices;  // of the spanning surface, in its order
    MadeOnce<SpanningSurface, SurfacePiece> surface;
  };
  std::optional<Pad> pad_;
};

}  // namespace condyle
