#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/tissue/spring_prism.h"
#include "sim/tissue/anatomy.h"
#include "sim/tissue/skin_region.h"

namespace condyle {

/// What a column of tissue stands on.
enum class Ground { none, cranium, mandible };

/// What the innermost node of a column grows on.
enum class Hold { free, cranium, mandible };

/// One column per vertex of the coarse skin, from the skin inward.
struct Column {
  Eigen::Vector3d inward = Eigen::Vector3d::Zero();  // unit
  double depth = 0;                                  // mm, of the innermost node
  Ground ground = Ground::none;                      // bone met within reach
  bool met_teeth = false;
  double met_depth = 0;                                  // mm, of what was met
  Eigen::Vector3d met_normal = Eigen::Vector3d::Zero();  // outward, of what was met
  Hold hold = Hold::free;
  double firm = 1;         // of the hold: 1 grown on, towards 0 more and more loosely
  bool cartilage = false;  // the nose: the whole column holds its shape
  double to_mouth = 1e9;   // mm from the opening between the lips
};

/// Coarse skin: the simulated surface with what the builder knows about its vertices.
struct CoarseSkin {
  TriMesh mesh;
  std::vector<char> rim;     // stays put
  std::vector<char> border;  // on a border of the face's own, the mouth left out
  MouthOutline mouth;
};

struct ColumnSettings {
  std::vector<double> layer_share;  // of the depth, outermost first; sums to 1
  double least_depth_mm = 3, greatest_depth_mm = 22;
  double greatest_free_depth_mm = 13;  // of what grows on no bone: cheeks, lips, throat
  double default_depth_mm = 12;        // where there is no bone in reach
  double march_mm = 25;
  double finer = 1;  // columns over the usual number of them: smoothing reaches as far at any
  int rounds(double usual) const {
    return std::max(1, static_cast<int>(std::lround(usual * finer)));
  }
};

/// Marches from the skin to the bone along smoothed normals.
std::vector<Column> march_columns(const CoarseSkin& skin, const Bones& bones,
                                  const ColumnSettings& settings);

/// What shaping did.
struct ShapedColumns {
  int thinned = 0;           // columns made thinner, where straight ones would cross
  std::vector<char> folded;  // per column: whether a prism on it is still weak
  bool sound() const;
};

/// Chooses depths, smooth and never beyond what was met, then thins columns until every prism has a
/// good volume. Wants `hold`.
ShapedColumns shape_columns(const CoarseSkin& skin, const ColumnSettings& settings,
                            std::vector<Column>& columns);

/// Smooths the sheet around folded columns; its borders stay.
void relax_folds(CoarseSkin& skin, const std::vector<char>& folded);

/// Lays folded triangles that hang on the sheet by one edge alone, as at the corners of a mouth,
/// flat beside the triangle across that edge.
void unfold_ears(CoarseSkin& skin, const std::vector<char>& folded);

/// Nodes of the columns in `node_of` order.
Nodes column_nodes(const CoarseSkin& skin, const std::vector<Column>& columns,
                   const ColumnSettings& settings);

}  // namespace condyle
