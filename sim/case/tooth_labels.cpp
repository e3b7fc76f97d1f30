#include "sim/case/tooth_labels.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/mesh/triangle_tree.h"

namespace condyle {

Part with_tooth_labels(TriMesh mesh, const Part& labelled, double reach_mm) {
  Part part{labelled.name, labelled.role, std::move(mesh), {}, labelled.body};
  const auto& teeth = labelled.teeth;
  if (part.mesh.empty() || teeth.empty()) return part;
  const TriangleTree tree(labelled.mesh);
  const auto tooth_at = [&](const Eigen::Vector3i& t) {
    const Eigen::Vector3d middle = (part.mesh.vertices[static_cast<std::size_t>(t[0])] +
                                    part.mesh.vertices[static_cast<std::size_t>(t[1])] +
                                    part.mesh.vertices[static_cast<std::size_t>(t[2])]) /
                                   3;
    const int nearest = tree.nearest(middle, reach_mm).triangle;
    const auto found = std::find_if(teeth.begin(), teeth.end(), [&](const Tooth& tooth) {
      return nearest >= tooth.first_triangle &&
             nearest < tooth.first_triangle + tooth.triangle_count;
    });
    return static_cast<std::size_t>(found - teeth.begin());
  };
  std::vector<std::vector<Eigen::Vector3i>> of_tooth(teeth.size() + 1);
  for (const auto& t : part.mesh.triangles) of_tooth[tooth_at(t)].push_back(t);
  part.mesh.triangles.clear();
  for (std::size_t i = 0; i < of_tooth.size(); ++i) {
    const int first = static_cast<int>(part.mesh.triangles.size());
    part.mesh.triangles.insert(part.mesh.triangles.end(), of_tooth[i].begin(), of_tooth[i].end());
    if (i < teeth.size() && !of_tooth[i].empty())
      part.teeth.push_back({teeth[i].fdi, first, static_cast<int>(of_tooth[i].size())});
  }
  return part;
}

}  // namespace condyle
