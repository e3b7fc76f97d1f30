#include "engine/cut/join_cells.h"

#include <algorithm>
#include <cstdint>
#include <tuple>

#include "engine/core/disjoint_sets.h"
#include "engine/cut/edge_key.h"

namespace condyle {
JoinedCells join_cells(const CellComplex& complex, const CellSides& sides) {
  const auto& faces = complex.faces();
  const int count = static_cast<int>(faces.size());
  std::vector<char> kerf(complex.cells());
  for (int cell = 0; cell < complex.cells(); ++cell) kerf[cell] = sides.is_kerf(cell);
  const auto is_bone = [&](int cell) { return cell >= 0 && !kerf[cell]; };
  const auto cell_at = [&](int face, bool behind) {
    return behind ? faces[face].back : faces[face].front;
  };

  // Member 2 i is the front of face i, 2 i + 1 its back.
  DisjointSets sets(2 * static_cast<std::size_t>(count));
  struct EdgeOfCell {
    std::uint64_t edge;
    int cell, member;
  };
  std::vector<EdgeOfCell> edges;
  edges.reserve(6 * static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    for (const bool behind : {false, true}) {
      const int cell = cell_at(i, behind);
      if (!is_bone(cell)) continue;
      for (int k = 0; k < 3; ++k)
        edges.push_back(
            {edge_key(faces[i].vertices[k], faces[i].vertices[(k + 1) % 3]), cell, 2 * i + behind});
    }
    if (is_bone(faces[i].front) && is_bone(faces[i].back) &&
        !sides.are_parted(faces[i].front, faces[i].back))
      sets.join(2 * i, 2 * i + 1);
  }
  std::sort(edges.begin(), edges.end(), [](const EdgeOfCell& a, const EdgeOfCell& b) {
    return std::tie(a.edge, a.cell, a.member) < std::tie(b.edge, b.cell, b.member);
  });
  for (std::size_t i = 1; i < edges.size(); ++i)
    if (edges[i].edge == edges[i - 1].edge && edges[i].cell == edges[i - 1].cell)
      sets.join(edges[i].member, edges[i - 1].member);

  JoinedCells joined;
  joined.of_face.assign(count, {-1, -1});
  std::vector<int> number(2 * static_cast<std::size_t>(count), -1);
  for (int i = 0; i < count; ++i)
    for (const bool behind : {false, true}) {
      if (!is_bone(cell_at(i, behind))) continue;
      int& part = number[sets.find(2 * i + behind)];
      if (part < 0) part = joined.parts++;
      joined.of_face[i][behind] = part;
    }
  return joined;
}

}  // namespace condyle
