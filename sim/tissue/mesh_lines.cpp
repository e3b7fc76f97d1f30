#include "sim/tissue/mesh_lines.h"

#include <algorithm>
#include <utility>

#include "sim/tissue/model.h"

namespace condyle {

std::vector<SpringLine> spring_lines(const TissueModel& model, const TissueState& state) {
  const auto& elements = model.mesh->elements;
  std::vector<SpringLine> lines(elements.spring_a.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto& a = state.nodes[elements.spring_a[i]];
    const auto& b = state.nodes[elements.spring_b[i]];
    lines[i] = {{a.cast<float>(), b.cast<float>()},
                static_cast<float>((b - a).norm() / std::max(elements.rest_length[i], 1e-6)),
                elements.spring_layer.empty() ? 0 : elements.spring_layer[i]};
  }
  return lines;
}

std::vector<MeshLine> prism_lines(const TissueModel& model, const TissueState& state) {
  constexpr std::array<std::array<int, 2>, 9> edges = {
      {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}};
  std::vector<std::pair<int, int>> all;
  for (const auto& prism : model.mesh->elements.prisms)
    for (const auto& [i, j] : edges) all.push_back(std::minmax(prism[i], prism[j]));
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::vector<MeshLine> lines;
  lines.reserve(all.size());
  for (const auto& [a, b] : all)
    lines.push_back({state.nodes[a].cast<float>(), state.nodes[b].cast<float>()});
  return lines;
}

std::vector<BoneSpringLine> bone_spring_lines(const TissueModel& model, const TissueState& state) {
  const MeshLoads loads = loads_at(model, state.X_CB, state.excitation);
  std::vector<BoneSpringLine> lines;
  for (std::size_t i = 0; i < loads.anchor_target.size(); ++i)
    lines.push_back({{state.nodes[model.mesh->elements.anchor_node[i]].cast<float>(),
                      loads.anchor_target[i].cast<float>()},
                     model.support.anchor.sum(i)});
  return lines;
}

}  // namespace condyle
