#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "render/face/fold_lines.h"

namespace condyle {

/// Folds of a displayed face, in pictures alone: the skin is displaced along the lines of
/// find_fold_lines in proportion to its compression across them relative to rest; a nasolabial fold
/// continues up to the ala. At rest, and along lines that are stretched, nothing changes, bit for
/// bit. Deterministic.
class SkinFolds {
 public:
  /// Darkening of a vertex in a groove.
  struct Shade {
    int vertex;
    float sky;  // factor of the visible fraction of the sky, 0 to 1
  };

  /// rest: displayed vertices of the face at rest, mm. normals: unit, one per vertex. rim: of the
  /// mouth; without one there are no folds.
  SkinFolds(std::span<const Eigen::Vector3f> rest, std::span<const Eigen::Vector3f> normals,
            std::span<const Eigen::Vector3i> triangles, std::span<const int> rim);

  /// Displaces the current positions. Returns the darker vertices; empty if nothing folds.
  std::vector<Shade> apply(std::vector<Eigen::Vector3f>& places) const;

 private:
  /// A distance across a line.
  struct Gauge {
    int from, to;  // vertices
    float rest_mm;
  };
  static constexpr std::size_t gauges_each = 2;
  struct Line {
    FoldLine line;
    std::vector<Gauge> gauges;  // `gauges_each` per sample
  };
  /// A vertex near a line.
  struct Member {
    int own;  // number among `vertices_`
    int line;
    float along;   // position, in samples
    float height;  // displacement over the depth of the fold
    float dark;    // 0 to 1, in the groove
  };
  std::vector<float> depths(const Line& line, std::span<const Eigen::Vector3f> places) const;

  std::vector<Line> lines_;
  std::vector<Member> members_;
  std::vector<int> vertices_;                 // of the members, ascending
  std::vector<Eigen::Vector3i> triangles_;    // with at least one of them
  std::vector<Eigen::Vector3i> corners_own_;  // their numbers among `vertices_`, else -1
};

}  // namespace condyle
