#pragma once

#include <Eigen/Core>
#include <cassert>
#include <span>
#include <vector>

namespace condyle {

/// Vertices as weighted sums of others. Vertex v has the terms first[v] up to first[v + 1], whose
/// weights add up to 1.
struct VertexSums {
  struct Term {
    int of;
    float weight;
  };
  std::vector<int> first = {0};
  std::vector<Term> terms;

  std::size_t size() const { return first.size() - 1; }
  void add(std::span<const Term> sum);

  /// The sums of the first `count` vertices.
  template <class T>
  std::vector<T> of(std::span<const T> values, std::size_t count) const {
    assert(count <= size());
    std::vector<T> sums(count);
    for (std::size_t v = 0; v < sums.size(); ++v) {
      auto at = static_cast<std::size_t>(first[v]);
      const auto end = static_cast<std::size_t>(first[v + 1]);
      T sum = terms[at].weight * values[static_cast<std::size_t>(terms[at].of)];
      while (++at < end) sum += terms[at].weight * values[static_cast<std::size_t>(terms[at].of)];
      sums[v] = sum;
    }
    return sums;
  }
  template <class T>
  std::vector<T> of(std::span<const T> values) const {
    return of(values, size());
  }
};

/// The outer sums expressed in the vertices of the inner ones.
VertexSums composed(const VertexSums& outer, const VertexSums& inner);

/// Each triangle split into four, with the positions of their vertices on the smooth surface: the
/// given ones first, then one for each edge. Rims become smooth curves.
/// source: Loop, Smooth Subdivision Surfaces Based on Triangles, 1987
struct Subdivision {
  std::vector<Eigen::Vector3i> triangles;
  VertexSums vertices;
};
Subdivision subdivide(int vertex_count, std::span<const Eigen::Vector3i> triangles);

}  // namespace condyle
