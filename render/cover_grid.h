#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

namespace condyle {

/// Where the sides of a surface meet: what is needed, beside its triangles, to tell where it has
/// rims from a given eye.
class SurfaceEdges {
 public:
  explicit SurfaceEdges(std::span<const Eigen::Vector3i> triangles);

  /// An edge and its two triangles, which run against each other along it; `right` is -1 at a rim
  /// and where the surface is no simple sheet.
  struct Edge {
    int a, b, left, right;
  };
  const std::vector<Edge>& all() const { return edges_; }

 private:
  std::vector<Edge> edges_;
};

/// What surely lies behind opaque surfaces, told on the processor before anything is drawn: for
/// each tile of the picture how far the surfaces are at most, where they close the tile. Never
/// calls hidden what is seen. The same on every machine.
class CoverGrid {
 public:
  /// view_projection: world to clip space. Forgets what was there.
  void start(int width, int height, const Eigen::Matrix4f& view_projection);

  /// Adds the front sides of a surface. It is given up as a whole when it comes near the eye.
  /// corners: the positions that the triangles use.
  void add(std::span<const Eigen::Vector3f> positions, std::span<const int> corners,
           std::span<const Eigen::Vector3i> triangles, const SurfaceEdges& edges,
           const Eigen::Matrix4f& model);

  /// To be called before the questions.
  void finish();
  /// Whether nothing can be seen of what lies in the rectangle, pixels from the lower left, and no
  /// nearer than the depth, in clip space.
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
    float farthest;    // of what reaches before the rim
    float covered_to;  // the same, once finished; infinite where the tile is open
    int layers;        // over its middle
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
  std::vector<Eigen::Vector3f> projected_;  // kept for their memory
  std::vector<char> sheet_;
};

}  // namespace condyle
