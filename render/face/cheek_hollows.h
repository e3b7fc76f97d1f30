#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "render/face/skin_folds.h"
#include "sim/frame/part.h"

namespace condyle {

/// Hollows of the cheeks between the masseter and the corner of the mouth, in pictures alone: as an
/// opening jaw stretches a cheek over the buccal space, it gets thinner and sinks in. Its width is
/// held by the masseter and the lips, so its thickness falls in inverse proportion to its height
/// (constant volume). At rest and where the cheek is not stretched by more than a twentieth,
/// nothing changes, bit for bit. Deterministic.
class CheekHollows {
 public:
  /// rest: displayed vertices of the face at rest, mm, LPS. normals: unit, one per vertex. rim: of
  /// the mouth. parts: of the patient; the thickness of a cheek is its distance from their jaws and
  /// teeth. Without a rim or jaws there are no hollows.
  CheekHollows(std::span<const Eigen::Vector3f> rest, std::span<const Eigen::Vector3f> normals,
               std::span<const int> rim, std::span<const Part* const> parts);

  /// Displaces the current positions, mm. Returns the darker vertices; empty if no cheek sinks in.
  std::vector<SkinFolds::Shade> apply(std::vector<Eigen::Vector3f>& places) const;

 private:
  static constexpr std::size_t columns = 3, rows = 7;  // of a side's gauge
  /// A vertex that sinks in.
  struct Member {
    int vertex;
    float weight;    // 0 to 1
    float limit_mm;  // largest displacement, so that it stays clear of the teeth
  };
  struct Cheek {
    std::array<std::array<int, rows>, columns> gauge = {};  // vertices, upward; forward first
    std::array<float, columns> rest_mm = {};                // lengths of the columns
    float thickness_mm = 0;
    float shade_per_mm = 0;  // darkening over the depth
    float outward = 1;       // sign of the normal that the gauge gives
    std::vector<Member> members = {};
  };
  static Eigen::Vector3f gauge_normal(const Cheek& cheek, std::span<const Eigen::Vector3f> places);
  static std::array<float, columns> lengths(const Cheek& cheek,
                                            std::span<const Eigen::Vector3f> places);

  std::vector<Cheek> cheeks_;
};

}  // namespace condyle
