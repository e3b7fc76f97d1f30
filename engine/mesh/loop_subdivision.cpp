#include "engine/mesh/loop_subdivision.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "engine/mesh/topology.h"

namespace condyle {
namespace {

using Term = VertexSums::Term;

/// The vertex opposite to an edge in a triangle.
int third_of(const Eigen::Vector3i& t, int a, int b) {
  for (const int v : t)
    if (v != a && v != b) return v;
  return a;
}

struct Around {
  std::vector<int> all, along_rim;  // neighbours; those along edges that do not have two triangles
};

std::vector<Term> moved(int vertex, const Around& around) {
  std::vector<Term> sum;
  if (around.along_rim.size() == 2) {
    sum = {{vertex, 0.75f}, {around.along_rim[0], 0.125f}, {around.along_rim[1], 0.125f}};
  } else if (!around.along_rim.empty() || around.all.empty()) {
    sum = {{vertex, 1.f}};  // where rims meet
  } else {
    const double n = static_cast<double>(around.all.size());
    const double c = 0.375 + 0.25 * std::cos(2 * std::numbers::pi / n);
    const double beta = (0.625 - c * c) / n;
    sum.push_back({vertex, static_cast<float>(1 - n * beta)});
    for (const int other : around.all) sum.push_back({other, static_cast<float>(beta)});
  }
  return sum;
}

}  // namespace

void VertexSums::add(std::span<const Term> sum) {
  terms.insert(terms.end(), sum.begin(), sum.end());
  first.push_back(static_cast<int>(terms.size()));
}

VertexSums composed(const VertexSums& outer, const VertexSums& inner) {
  VertexSums sums;
  std::vector<Term> sum;
  for (std::size_t v = 0; v < outer.size(); ++v) {
    sum.clear();
    for (int i = outer.first[v]; i < outer.first[v + 1]; ++i) {
      const Term& through = outer.terms[static_cast<std::size_t>(i)];
      const auto from = static_cast<std::size_t>(through.of);
      assert(from < inner.size());
      for (int k = inner.first[from]; k < inner.first[from + 1]; ++k) {
        const Term& fraction = inner.terms[static_cast<std::size_t>(k)];
        sum.push_back({fraction.of, through.weight * fraction.weight});
      }
    }
    std::stable_sort(sum.begin(), sum.end(),
                     [](const Term& a, const Term& b) { return a.of < b.of; });
    std::size_t kept = 0;
    for (std::size_t i = 1; i < sum.size(); ++i)
      if (sum[i].of == sum[kept].of)
        sum[kept].weight += sum[i].weight;
      else
        sum[++kept] = sum[i];
    sums.add({sum.data(), std::min(kept + 1, sum.size())});
  }
  return sums;
}

Subdivision subdivide(int vertex_count, std::span<const Eigen::Vector3i> triangles) {
  TriMesh mesh;
  mesh.vertices.resize(static_cast<std::size_t>(vertex_count));
  mesh.triangles.assign(triangles.begin(), triangles.end());
  const EdgeList list = find_edges(mesh);

  std::vector<Around> around(mesh.vertices.size());
  for (const auto& edge : list.edges)
    for (const auto& [v, other] :
         {std::pair(edge.low, edge.high), std::pair(edge.high, edge.low)}) {
      auto& here = around[static_cast<std::size_t>(v)];
      here.all.push_back(other);
      if (edge.count != 2) here.along_rim.push_back(other);
    }
  Subdivision result;
  for (int v = 0; v < vertex_count; ++v)
    result.vertices.add(moved(v, around[static_cast<std::size_t>(v)]));
  for (const auto& edge : list.edges) {
    if (edge.count != 2) {
      result.vertices.add(std::vector<Term>{{edge.low, 0.5f}, {edge.high, 0.5f}});
      continue;
    }
    const auto beside = [&](int side) {
      const auto t = list.sides[static_cast<std::size_t>(edge.first + side)].triangle;
      return third_of(mesh.triangles[static_cast<std::size_t>(t)], edge.low, edge.high);
    };
    result.vertices.add(std::vector<Term>{
        {edge.low, 0.375f}, {edge.high, 0.375f}, {beside(0), 0.125f}, {beside(1), 0.125f}});
  }

  const auto middle = [&](int a, int b) {
    const auto at = std::lower_bound(list.edges.begin(), list.edges.end(), std::minmax(a, b),
                                     [](const Edge& edge, const std::pair<int, int>& ends) {
                                       return std::pair(edge.low, edge.high) < ends;
                                     });
    return vertex_count + static_cast<int>(at - list.edges.begin());
  };
  for (const auto& t : triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    const int a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
    result.triangles.insert(result.triangles.end(),
                            {{t[0], a, c}, {t[1], b, a}, {t[2], c, b}, {a, b, c}});
  }
  return result;
}

}  // namespace condyle
