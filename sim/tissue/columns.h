#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "engine/tissue/spring_prism.h"
#include "sim/frame/body_tree.h"
#include "sim/tissue/anatomy.h"
#include "sim/tissue/skin_region.h"

namespace condyle {

/// One column per vertex of the coarse skin, from the skin inward.
struct Column {
  Eigen::Vector3d inward = Eigen::Vector3d::Zero();  // unit
  double depth = 0;                                  // mm, of the innermost node
  std::optional<BodyId> support;                     // body of the bone hit within reach
  bool met_teeth = false, met_globe = false;
  double met_depth = 0;                                  // mm, of the surface that was hit
  Eigen::Vector3d met_normal = Eigen::Vector3d::Zero();  // outward, of the surface that was hit
  std::optional<BodyId> attached_to;  // body that the innermost node is attached to
  double firmness = 1;     // of the attachment: 1 grown on bone, towards 0 more and more loose
  bool cartilage = false;  // the nose: the whole column is stiff
  double to_mouth = 1e9;   // mm from the opening between the lips
};

/// Coarse skin: the simulated surface with the kinds of its vertices.
struct CoarseSkin {
  TriMesh mesh;
  std::vector<char> rim;     // fixed
  std::vector<char> border;  // on a free border of the face, the mouth excluded
  MouthOutline mouth;
  std::optional<Eyes> eyes;  // of a sheet that goes on around them
};

struct ColumnSettings {
  std::vector<double> layer_fraction;  // of the depth, outermost first; sums to 1
  double min_depth_mm = 3, greatest_depth_mm = 22;
  double greatest_free_depth_mm = 13;  // of columns not attached to bone: cheeks, lips, throat
  double default_depth_mm = 12;        // without bone in reach
  double march_mm = 25;
  // columns over the default number: the reach of smoothing in mm does not depend on it
  double finer = 1;
  int rounds(double by_default) const {
    return std::max(1, static_cast<int>(std::lround(by_default * finer)));
  }
};

/// Marches from the skin to the bone along smoothed normals.
std::vector<Column> march_columns(const CoarseSkin& skin, const Bones& bones,
                                  const ColumnSettings& settings);

/// Result of shaping.
struct ShapedColumns {
  int thinned = 0;           // columns thinned where straight ones would cross
  std::vector<char> folded;  // per column: whether one of its prisms is still degenerate
  bool sound() const;
};

/// Chooses smooth depths that never exceed what was hit, then thins columns until every prism has a
/// sound volume. Reads `attached_to`.
ShapedColumns shape_columns(const CoarseSkin& skin, const ColumnSettings& settings,
                            std::vector<Column>& columns);

/// Smooths the sheet around folded columns, up to so many rings of neighbours. Its borders are
/// fixed; from four rings on, the folded vertices of those other than the mouth move along
/// them, too.
void relax_folds(CoarseSkin& skin, const std::vector<char>& folded, int rings);

/// Flattens folded triangles that are connected to the sheet by one edge only, as at the corners of
/// a mouth, beside the triangle across that edge.
void unfold_ears(CoarseSkin& skin, const std::vector<char>& folded);

/// Nodes of the columns in `node_of` order.
Nodes column_nodes(const CoarseSkin& skin, const std::vector<Column>& columns,
                   const ColumnSettings& settings);

}  // namespace condyle
