#include "sim/contact/near_triangles.h"

#include <algorithm>
#include <numeric>

#include "engine/mesh/measure.h"

namespace condyle {

namespace {
constexpr int leaf_size = 16;
}

NearTriangles::NearTriangles(const TriMesh& mesh) {
  std::vector<Eigen::Vector3d> middles;
  middles.reserve(mesh.triangles.size());
  for (const auto& t : mesh.triangles)
    middles.push_back((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3);
  std::vector<int> order(middles.size());
  std::iota(order.begin(), order.end(), 0);
  build(mesh, middles, order, 0, static_cast<int>(order.size()));
  soup_.vertices.reserve(3 * order.size());
  soup_.triangles.reserve(order.size());
  for (const int i : order) {
    const int first = static_cast<int>(soup_.vertices.size());
    for (const int v : mesh.triangles[static_cast<std::size_t>(i)])
      soup_.vertices.push_back(mesh.vertices[v]);
    soup_.triangles.emplace_back(first, first + 1, first + 2);
  }
}

int NearTriangles::build(const TriMesh& mesh, const std::vector<Eigen::Vector3d>& middles,
                         std::vector<int>& order, int first, int last) {
  const int index = static_cast<int>(balls_.size());
  balls_.emplace_back();
  Box box;
  for (int i = first; i < last; ++i)
    for (const int v : mesh.triangles[static_cast<std::size_t>(order[i])])
      box.add(mesh.vertices[v]);
  Ball ball{box.center(), 0, first, last - first, 0};
  for (int i = first; i < last; ++i)
    for (const int v : mesh.triangles[static_cast<std::size_t>(order[i])])
      ball.radius = std::max(ball.radius, (mesh.vertices[v] - ball.center).norm());
  if (last - first > leaf_size) {
    Eigen::Index axis = 0;
    box.size().maxCoeff(&axis);
    const int half = (first + last) / 2;
    std::nth_element(order.begin() + first, order.begin() + half, order.begin() + last,
                     [&](int i, int j) {
                       return std::pair(middles[i][axis], i) < std::pair(middles[j][axis], j);
                     });
    build(mesh, middles, order, first, half);
    ball.right = build(mesh, middles, order, half, last);
  }
  balls_[static_cast<std::size_t>(index)] = ball;
  return index;
}

TriMesh NearTriangles::near(const Pose& X_W, const SignedSurface& other, const Pose& X_WO,
                            double reach_mm) const {
  const Pose X = X_WO.inverse() * X_W;
  TriMesh found;
  const auto visit = [&](const auto& self, int index) -> void {
    const Ball& ball = balls_[static_cast<std::size_t>(index)];
    const Eigen::Vector3d center = X * ball.center;
    if (!other.box().contains(center, ball.radius + reach_mm)) return;
    if (other.distance(center) > ball.radius + reach_mm) return;
    if (ball.right != 0) {
      self(self, index + 1);
      self(self, ball.right);
      return;
    }
    for (int i = ball.first; i < ball.first + ball.count; ++i) {
      const int first = static_cast<int>(found.vertices.size());
      for (const int v : soup_.triangles[static_cast<std::size_t>(i)])
        found.vertices.push_back(soup_.vertices[static_cast<std::size_t>(v)]);
      found.triangles.emplace_back(first, first + 1, first + 2);
    }
  };
  visit(visit, 0);
  return found;
}

}  // namespace condyle
