#include "sim/tissue/net_lines.h"

#include <algorithm>
#include <utility>

#include "sim/tissue/model.h"

namespace condyle {

std::vector<NetSpringLine> spring_lines(const TissueModel& model, const TissueState& state) {
  const auto& net = model.net;
  std::vector<NetSpringLine> lines(net.spring_a.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto& a = state.nodes[net.spring_a[i]];
    const auto& b = state.nodes[net.spring_b[i]];
    lines[i] = {{a.cast<float>(), b.cast<float>()},
                static_cast<float>((b - a).norm() / std::max(net.rest_length[i], 1e-6)),
                net.spring_layer.empty() ? 0 : net.spring_layer[i]};
  }
  return lines;
}

std::vector<NetLine> prism_lines(const TissueModel& model, const TissueState& state) {
  constexpr std::array<std::array<int, 2>, 9> edges = {
      {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}};
  std::vector<std::pair<int, int>> all;
  for (const auto& prism : model.net.prisms)
    for (const auto& [i, j] : edges) all.push_back(std::minmax(prism[i], prism[j]));
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::vector<NetLine> lines;
  lines.reserve(all.size());
  for (const auto& [a, b] : all)
    lines.push_back({state.nodes[a].cast<float>(), state.nodes[b].cast<float>()});
  return lines;
}

std::vector<BoneSpringLine> bone_spring_lines(const TissueModel& model, const TissueState& state) {
  const NetLoads loads = loads_at(model, state.X_CM);
  std::vector<BoneSpringLine> lines;
  for (std::size_t i = 0; i < loads.anchor_target.size(); ++i)
    lines.push_back({{state.nodes[model.net.anchor_node[i]].cast<float>(),
                      loads.anchor_target[i].cast<float>()},
                     model.anchor_share[i]});
  return lines;
}

}  // namespace condyle
