#include "engine/mesh/slit_seam.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <queue>

#include "engine/core/infinity.h"

namespace condyle {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double to_end_mm = 20;  // from a seam's full width to its end

/// Triangles at each vertex.
class Around {
 public:
  explicit Around(const TriMesh& mesh) : first_(mesh.vertices.size() + 1, 0) {
    for (const auto& t : mesh.triangles)
      for (const int v : t) ++first_[static_cast<std::size_t>(v) + 1];
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    triangles_.resize(3 * mesh.triangles.size());
    auto next = first_;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (const int v : mesh.triangles[t])
        triangles_[next[static_cast<std::size_t>(v)]++] = static_cast<int>(t);
  }
  std::span<const int> operator[](int v) const {
    const auto i = static_cast<std::size_t>(v);
    return std::span(triangles_).subspan(first_[i], first_[i + 1] - first_[i]);
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<int> triangles_;
};

/// Depth map of the frontmost surface, over a part of the front view, mm.
class FrontView {
 public:
  FrontView(const TriMesh& surface, const Eigen::AlignedBox3d& region) : low_(view(region.min())) {
    const Vector2d size = view(region.max()) - low_;
    columns_ = static_cast<int>(size.x() / cell_mm) + 1;
    rows_ = static_cast<int>(size.y() / cell_mm) + 1;
    nearest_.assign(static_cast<std::size_t>(columns_ * rows_), infinity);
    for (const auto& t : surface.triangles) draw(surface, t);
  }
  bool hides(const Vector3d& p) const {
    const Vector2d at = (view(p) - low_) / cell_mm;
    const int c = static_cast<int>(std::lround(std::clamp(at.x(), -1.0, columns_ + 0.0))),
              r = static_cast<int>(std::lround(std::clamp(at.y(), -1.0, rows_ + 0.0)));
    return c >= 0 && r >= 0 && c < columns_ && r < rows_ &&
           nearest_[static_cast<std::size_t>(r * columns_ + c)] < p.y() - clear_mm;
  }

 private:
  static constexpr double cell_mm = 0.3, clear_mm = 0.8;
  static Vector2d view(const Vector3d& p) { return {p.x(), p.z()}; }

  void draw(const TriMesh& surface, const Eigen::Vector3i& t) {
    const Vector3d &p = surface.vertices[static_cast<std::size_t>(t[0])],
                   &q = surface.vertices[static_cast<std::size_t>(t[1])],
                   &r = surface.vertices[static_cast<std::size_t>(t[2])];
    const Vector2d a = (view(p) - low_) / cell_mm, b = (view(q) - low_) / cell_mm,
                   c = (view(r) - low_) / cell_mm;
    const Vector2d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    if (high.x() < 0 || high.y() < 0 || low.x() > columns_ || low.y() > rows_) return;
    const Eigen::Matrix2d sides = (Eigen::Matrix2d() << b - a, c - a).finished();
    if (std::abs(sides.determinant()) < 1e-12) return;
    const Eigen::Matrix2d to_barycentric = sides.inverse();
    const auto first = [](double v) { return std::max(0, static_cast<int>(std::ceil(v))); };
    for (int row = first(low.y()); row < rows_ && row <= high.y(); ++row)
      for (int column = first(low.x()); column < columns_ && column <= high.x(); ++column) {
        const Vector2d fraction = to_barycentric * (Vector2d(column, row) - a);
        if (fraction.minCoeff() < 0 || fraction.sum() > 1) continue;
        double& kept = nearest_[static_cast<std::size_t>(row * columns_ + column)];
        kept =
            std::min(kept, p.y() + fraction.x() * (q.y() - p.y()) + fraction.y() * (r.y() - p.y()));
      }
  }

  Vector2d low_;
  int columns_ = 0, rows_ = 0;
  std::vector<double> nearest_;
};

struct Inside {
  std::vector<double>
      distance;  // of each vertex from the visible ones, along edges; negative: not hidden
  double right = infinity, left = -infinity;  // ends of the slit
};

/// The vertices that are connected with these and hidden in the front view.
Inside find_inside(const TriMesh& surface, const Around& around, std::span<const int> from,
                   const FrontView& front_view) {
  std::vector<double> distance(surface.vertices.size(), -1);
  std::vector<char> seen(surface.vertices.size(), 0);
  std::vector<int> front(from.begin(), from.end()), edge;
  for (const int v : from) seen[static_cast<std::size_t>(v)] = 1;
  while (!front.empty()) {
    const int v = front.back();
    front.pop_back();
    if (!front_view.hides(surface.vertices[static_cast<std::size_t>(v)])) {
      edge.push_back(v);
      continue;
    }
    distance[static_cast<std::size_t>(v)] = infinity;
    for (const int t : around[v])
      for (const int n : surface.triangles[static_cast<std::size_t>(t)])
        if (!seen[static_cast<std::size_t>(n)]) {
          seen[static_cast<std::size_t>(n)] = 1;
          front.push_back(n);
        }
  }
  Inside found;
  for (const int v : edge) {
    found.right = std::min(found.right, surface.vertices[static_cast<std::size_t>(v)].x());
    found.left = std::max(found.left, surface.vertices[static_cast<std::size_t>(v)].x());
  }
  using Waiting = std::pair<double, int>;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> waiting;
  for (const int v : edge) waiting.push({0, v});
  while (!waiting.empty()) {
    const auto [so_far, v] = waiting.top();
    waiting.pop();
    if (so_far > distance[static_cast<std::size_t>(v)] && so_far > 0) continue;
    for (const int t : around[v])
      for (const int n : surface.triangles[static_cast<std::size_t>(t)]) {
        double& known = distance[static_cast<std::size_t>(n)];
        const double next = so_far + (surface.vertices[static_cast<std::size_t>(n)] -
                                      surface.vertices[static_cast<std::size_t>(v)])
                                         .norm();
        if (next >= known) continue;
        known = next;
        waiting.push({next, n});
      }
  }
  found.distance = std::move(distance);
  return found;
}

}  // namespace

std::vector<Eigen::Vector3i> without_deep_inside(const TriMesh& surface,
                                                 std::span<const int> inside,
                                                 const Vector3d& middle, double beside_mm,
                                                 const SlitSeam& seam) {
  const Around around(surface);
  const Vector3d beside = Vector3d::Constant(beside_mm);
  const auto found =
      find_inside(surface, around, inside, FrontView(surface, {middle - beside, middle + beside}));
  const auto deep = [&](int v) {
    const double x = surface.vertices[static_cast<std::size_t>(v)].x();
    const double from_end = std::min(x - found.right, found.left - x);
    const double t = std::clamp(from_end / to_end_mm, 0.0, 1.0);
    return found.distance[static_cast<std::size_t>(v)] >
           seam.at_ends_mm + (seam.at_sides_mm - seam.at_ends_mm) * t * t * t;
  };
  std::vector<char> dropped(surface.triangles.size(), 0), seen(surface.vertices.size(), 0);
  std::vector<int> front;
  for (const int v : inside)
    if (deep(v)) front.push_back(v), seen[static_cast<std::size_t>(v)] = 1;
  while (!front.empty()) {
    const int v = front.back();
    front.pop_back();
    for (const int t : around[v]) {
      const auto& corners = surface.triangles[static_cast<std::size_t>(t)];
      if (!std::all_of(corners.begin(), corners.end(), deep)) continue;
      dropped[static_cast<std::size_t>(t)] = 1;
      for (const int n : corners)
        if (!seen[static_cast<std::size_t>(n)]) {
          seen[static_cast<std::size_t>(n)] = 1;
          front.push_back(n);
        }
    }
  }
  std::vector<Eigen::Vector3i> kept;
  for (std::size_t t = 0; t < dropped.size(); ++t)
    if (!dropped[t]) kept.push_back(surface.triangles[t]);
  return kept;
}

}  // namespace condyle
