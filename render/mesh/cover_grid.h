#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

namespace condyle {

/// The edges of a surface: needed, besides its triangles, to find its silhouette rims from a given
/// eye.
class SurfaceEdges {
 public:
  explicit SurfaceEdges(std::span<const Eigen::Vector3i> triangles);

  /// An edge and its two triangles, of opposite direction along it; `right` is -1 at a border and
  /// where the surface is not a manifold sheet.
  struct Edge {
    int a, b, left, right;
  };
  const std::vector<Edge>& all() const { return edges_; }

 private:
  std::vector<Edge> edges_;
};

/// Conservative occlusion test on the CPU, before anything is drawn: for each tile of the picture,
/// the largest depth of the surfaces that cover it completely. Never reports visible geometry as
/// hidden. Deterministic on every machine.
class CoverGrid {
 public:
  /// view_projection: world to clip space. Clears the grid.
  void start(int width, int height, const Eigen::Matrix4f& view_projection);

  /// Adds the front faces of a surface. The whole surface is skipped when it comes near the eye.
  /// corners: the positions that the triangles use.
  void add(std::span<const Eigen::Vector3f> positions, std::span<const int> corners,
           std::span<const Eigen::Vector3i> triangles, const SurfaceEdges& edges,
           const Eigen::Matrix4f& model);

  /// Must be called before any query.
  void finish();
  /// Whether nothing within the rectangle, pixels from the lower left, at this depth in clip space
  /// or farther, is visible.
  bool hides(const Eigen::Vector2f& low, const Eigen::Vector2f& high, float nearest) const {
    const Range reach = range(low, high);
    for (int y = reach.y0; y <= reach.y1; ++y)
      for (int x = reach.x0; x <= reach.x1; ++x)
        if (!(nearest > tiles_[static_cast<std::size_t>(y * columns_ + x)].covered_to))
          return false;
    return true;
  }
  bool empty() const { return !any_; }

 private:
  struct Tile {
    float rim;         // depth of the nearest rim, in clip space
    float farthest;    // of triangles in front of the rim
    float covered_to;  // the same, once finished; infinite where the tile is not covered
    int layers;        // over its centre
  };
  struct Range {
    int x0, y0, x1, y1;  // inclusive
  };
  Range range(const Eigen::Vector2f& low, const Eigen::Vector2f& high) const;
  template <class Visit>
  void each_tile(const Eigen::Vector2f& low, const Eigen::Vector2f& high, const Visit& visit);

  int width_ = 0, height_ = 0, columns_ = 0, rows_ = 0;
  bool any_ = false;
  Eigen::Matrix4f view_projection_;
  std::vector<Tile> tiles_;
  std::vector<Eigen::Vector3f> projected_;  // reused between calls
  std::vector<char> sheet_;
};

}  // namespace condyle
