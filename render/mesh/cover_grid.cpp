#include "render/mesh/cover_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace condyle {
namespace {

constexpr int tile = 4;               // pixels per side
constexpr float snap = 1.f / 64;      // pixels; GPUs move corners by less
constexpr float depth_error = 2e-5f;  // in clip space; rounding here and on the GPU
constexpr float infinite = std::numeric_limits<float>::infinity();

/// Twice the area of a, b and (x, y), positive when counter-clockwise.
float area_of(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float x, float y) {
  return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
}

/// A triangle in the picture.
struct Corners {
  const Eigen::Vector3f &a, &b, &c;
  float area;  // twice
  Eigen::Vector2f low, high;

  Corners(const std::vector<Eigen::Vector3f>& at, const Eigen::Vector3i& t)
      : a(at[t[0]]),
        b(at[t[1]]),
        c(at[t[2]]),
        area(area_of(a, b, c.x(), c.y())),
        low(a.cwiseMin(b).cwiseMin(c).head<2>()),
        high(a.cwiseMax(b).cwiseMax(c).head<2>()) {}
  /// Winding number about the point: 1, -1 or 0.
  int around(float x, float y) const {
    const float p = area_of(a, b, x, y), q = area_of(b, c, x, y), r = area_of(c, a, x, y);
    if (p >= 0 && q >= 0 && r >= 0) return 1;
    return p <= 0 && q <= 0 && r <= 0 ? -1 : 0;
  }
};

}  // namespace

SurfaceEdges::SurfaceEdges(std::span<const Eigen::Vector3i> triangles) {
  struct Half {
    int low, high, triangle;
    bool forward;
  };
  std::vector<Half> halves;
  halves.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      halves.push_back({std::min(a, b), std::max(a, b), static_cast<int>(t), a < b});
    }
  std::sort(halves.begin(), halves.end(), [](const Half& p, const Half& q) {
    if (p.low != q.low) return p.low < q.low;
    if (p.high != q.high) return p.high < q.high;
    return p.triangle < q.triangle;
  });
  for (std::size_t i = 0; i < halves.size();) {
    std::size_t end = i;
    while (end < halves.size() && halves[end].low == halves[i].low &&
           halves[end].high == halves[i].high)
      ++end;
    const auto& h = halves[i];
    if (end - i == 2 && h.forward != halves[i + 1].forward) {
      edges_.push_back({h.low, h.high, h.triangle, halves[i + 1].triangle});
      i = end;
    }
    for (; i < end; ++i) edges_.push_back({h.low, h.high, halves[i].triangle, -1});
  }
}

void CoverGrid::start(int width, int height, const Eigen::Matrix4f& view_projection) {
  width_ = width;
  height_ = height;
  columns_ = (width + tile - 1) / tile;
  rows_ = (height + tile - 1) / tile;
  view_projection_ = view_projection;
  any_ = false;
  tiles_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_),
                {infinite, -infinite, infinite, 0});
}

CoverGrid::Range CoverGrid::range(const Eigen::Vector2f& low, const Eigen::Vector2f& high) const {
  // Truncation is rounding down here; std::floor is a function call on a baseline processor.
  const auto first = [](float pixel) { return static_cast<int>(std::max(pixel, 0.f) / tile); };
  const auto last = [](float pixel, int count) {
    return pixel < 0 ? -1 : std::min(static_cast<int>(pixel / tile), count - 1);
  };
  // Far outside, values may exceed the range of int.
  const Eigen::Vector2f most(static_cast<float>(width_ + tile), static_cast<float>(height_ + tile));
  return {first(std::min(low.x() - snap, most.x())), first(std::min(low.y() - snap, most.y())),
          last(std::min(high.x() + snap, most.x()), columns_),
          last(std::min(high.y() + snap, most.y()), rows_)};
}

template <class Visit>
void CoverGrid::each_tile(const Eigen::Vector2f& low, const Eigen::Vector2f& high,
                          const Visit& visit) {
  const Range reach = range(low, high);
  for (int y = reach.y0; y <= reach.y1; ++y)
    for (int x = reach.x0; x <= reach.x1; ++x)
      visit(tiles_[static_cast<std::size_t>(y * columns_ + x)], x, y);
}

void CoverGrid::add(std::span<const Eigen::Vector3f> positions, std::span<const int> corners,
                    std::span<const Eigen::Vector3i> triangles, const SurfaceEdges& edges,
                    const Eigen::Matrix4f& model) {
  const Eigen::Matrix4f to_clip = view_projection_ * model;
  const Eigen::Vector2f half(0.5f * static_cast<float>(width_), 0.5f * static_cast<float>(height_));
  projected_.resize(positions.size());
  for (const int corner : corners) {
    const auto i = static_cast<std::size_t>(corner);
    const Eigen::Vector4f p = to_clip * positions[i].homogeneous();
    const float inverse = 1 / p.w();
    projected_[i] << (p.x() * inverse + 1) * half.x(), (p.y() * inverse + 1) * half.y(),
        p.z() * inverse;
    if (!(p.w() > 0) || !(p.z() > -p.w())) return;  // it may be clipped by the near plane
  }
  // The sheet consists of front faces and of triangles so narrow that rounding may flip them: such
  // folds cover a point once more forward than backward, and so leave no gap.
  sheet_.assign(triangles.size(), 0);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Corners t(projected_, triangles[i]);
    sheet_[i] = t.area > -4 * snap * (t.high - t.low).sum();
  }
  for (const auto& edge : edges.all()) {
    const bool left = sheet_[static_cast<std::size_t>(edge.left)];
    const bool right = edge.right >= 0 && sheet_[static_cast<std::size_t>(edge.right)];
    if (left == right) continue;
    const Eigen::Vector3f &a = projected_[edge.a], &b = projected_[edge.b];
    const float nearest = std::min(a.z(), b.z());
    each_tile(a.cwiseMin(b).head<2>(), a.cwiseMax(b).head<2>(),
              [&](Tile& at, int, int) { at.rim = std::min(at.rim, nearest); });
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!sheet_[i]) continue;
    const Corners t(projected_, triangles[i]);
    const float nearest = std::min({t.a.z(), t.b.z(), t.c.z()});
    const float farthest = std::max({t.a.z(), t.b.z(), t.c.z()});
    each_tile(t.low, t.high, [&](Tile& at, int x, int y) {
      if (nearest >= at.rim) return;
      at.farthest = std::max(at.farthest, farthest);
      at.layers +=
          t.around(tile * (static_cast<float>(x) + 0.5f), tile * (static_cast<float>(y) + 0.5f));
    });
  }
  any_ = true;
}

void CoverGrid::finish() {
  // Neighbours in a sheet share corners. Therefore triangles nearer than all rims of a tile are
  // connected within it, unless one crosses the depth of the nearest rim; and if the centre of the
  // tile is covered, all of it is.
  for (auto& at : tiles_)
    at.covered_to = at.layers > 0 && at.farthest < at.rim ? at.farthest + depth_error : infinite;
}

}  // namespace condyle
