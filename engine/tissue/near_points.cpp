#include "engine/tissue/near_points.h"

namespace condyle {

NearPoints::Runs::Runs(const std::vector<MeshPoint>& points) : point{0}, first_node{0} {
  constexpr int most = 8;
  const int count = static_cast<int>(points.size());
  for (int first = 0; first < count; first = point.back()) {
    const int end = std::min(first + most, count);
    for (int i = first; i < end; ++i)
      node.insert(node.end(), points[i].node.begin(), points[i].node.begin() + points[i].count);
    const auto own = node.begin() + first_node.back();
    std::sort(own, node.end());
    node.erase(std::unique(own, node.end()), node.end());
    point.push_back(end);
    first_node.push_back(static_cast<int>(node.size()));
  }
}

void NearPoints::moved(const std::vector<MeshPoint>& points, Nodes x) {
  if (last_.size() != x.size()) {  // first call for this mesh
    runs_ = std::make_shared<const Runs>(points);
    path_.assign(x.size(), 0.0);
    path_then_.assign(runs_->node.size(), 0.0);
    bound_.assign(points.size(), -far_mm);
    bound_of_run_.assign(runs_->point.size() - 1, -far_mm);
  } else {
    for (std::size_t n = 0; n < x.size(); ++n) path_[n] += (x[n] - last_[n]).norm();
  }
  last_ = std::move(x);
}

double NearPoints::path_of_run(std::size_t run) const {
  double most = 0;
  for (int k = runs_->first_node[run]; k < runs_->first_node[run + 1]; ++k)
    most = std::max(most, path_[runs_->node[k]] - path_then_[k]);
  return most;
}

void NearPoints::seen(std::size_t run) {
  for (int k = runs_->first_node[run]; k < runs_->first_node[run + 1]; ++k)
    path_then_[k] = path_[runs_->node[k]];
}

}  // namespace condyle
