#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/mesh/tri_mesh.h"

namespace condyle {

/// Values on a flat grid, x fastest; sample (i, j) lies at low + step * (i, j).
struct FlatGrid {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  double step_mm = 0.2;
  int columns = 0, rows = 0;
  std::vector<float> values;

  float& at(int i, int j) { return values[static_cast<std::size_t>(j) * columns + i]; }
  float at(int i, int j) const { return values[static_cast<std::size_t>(j) * columns + i]; }
  /// Bilinear; points outside take the nearest border value.
  double operator()(double x, double y) const;
};

/// Where crowns begin, seen along z: heights of their tips, smoothed along the arch.
struct TipHeights {
  struct Tip {
    double x, y, z;
  };
  std::vector<Tip> tips;

  double operator()(double x, double y) const;
};

/// Tips of an arch whose teeth point down (`down`) or up, in grid axes; `level`: about their
/// height.
TipHeights find_tips(const TriMesh& arch, double level_mm, bool down);

/// Distance from the outline of a horseshoe plate, negative inside. It reaches `wall_mm` beyond all
/// that the arches cover in their outermost `depth_mm`, spans gaps between teeth, and is rounded.
struct ArchCrowns {
  const TriMesh& mesh;
  const TipHeights& tips;
  bool down;
};
FlatGrid plate_outline(const std::vector<ArchCrowns>& arches, double depth_mm, double wall_mm,
                       double step_mm);

/// Moves the face of a plate toward the arch where teeth enclose a fossa that is deeper than the
/// print, by `most_mm` at most, so that the plate fills it. `face`: z of that side of the plate.
void fill_fossae(FlatGrid& face, const TriMesh& arch, bool down, double most_mm);

}  // namespace condyle
