#include "engine/mesh/unfold.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <vector>

#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Eigen::Vector3d;

class Unfolding {
 public:
  Unfolding(TriMesh& mesh, const UnfoldSettings& settings)
      : mesh_(mesh), settings_(settings), edges_(find_edges(mesh)), start_(mesh.vertices) {}

  int run() {
    int folds = mark();
    for (int round = 0; round < settings_.rounds && folds > 0; ++round) {
      move_marked();
      folds = mark();
    }
    return folds;
  }

 private:
  Vector3d& at(int vertex) { return mesh_.vertices[static_cast<std::size_t>(vertex)]; }
  Vector3d normal(int triangle) {
    const auto& t = mesh_.triangles[static_cast<std::size_t>(triangle)];
    return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).normalized();
  }

  /// Marks the corners of folded triangles. Returns the number of folded edges.
  int mark() {
    marked_.assign(mesh_.vertices.size(), 0);
    int folds = 0;
    for (const Edge& edge : edges_.edges) {
      if (edge.count != 2) continue;
      const int a = edges_.sides[static_cast<std::size_t>(edge.first)].triangle;
      const int b = edges_.sides[static_cast<std::size_t>(edge.first) + 1].triangle;
      if (normal(a).dot(normal(b)) >= settings_.cosine) continue;
      ++folds;
      for (const int t : {a, b})
        for (int k = 0; k < 3; ++k)
          marked_[static_cast<std::size_t>(mesh_.triangles[static_cast<std::size_t>(t)][k])] = 1;
    }
    return folds;
  }

  void move_marked() {
    sum_.assign(mesh_.vertices.size(), Vector3d::Zero());
    count_.assign(mesh_.vertices.size(), 0);
    for (const Edge& edge : edges_.edges)
      for (const auto& [one, other] :
           {std::pair{edge.low, edge.high}, std::pair{edge.high, edge.low}}) {
        const auto i = static_cast<std::size_t>(one);
        if (!marked_[i]) continue;
        sum_[i] += at(other);
        ++count_[i];
      }
    for (std::size_t i = 0; i < marked_.size(); ++i) {
      if (!marked_[i] || count_[i] == 0) continue;
      const Vector3d by = sum_[i] / count_[i] - start_[i];
      const double far = by.norm() / settings_.most_mm;
      mesh_.vertices[i] = start_[i] + by / std::max(1.0, far);
    }
  }

  TriMesh& mesh_;
  const UnfoldSettings& settings_;
  EdgeList edges_;
  std::vector<Vector3d> start_, sum_;
  std::vector<char> marked_;
  std::vector<int> count_;
};

}  // namespace

int unfold(TriMesh& mesh, const UnfoldSettings& settings) {
  return Unfolding(mesh, settings).run();
}

}  // namespace condyle
