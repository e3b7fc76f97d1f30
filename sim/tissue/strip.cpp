#include "sim/tissue/strip.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "engine/tissue/layered_mesh.h"
#include "sim/tissue/model.h"

namespace condyle {
namespace {

/// Points of stripped tissue that may now touch bone: inner nodes, and between them.
std::vector<MeshPoint> freed_points(const TissueModel& model, std::span<const double> kept) {
  constexpr double loose = 0.5, spacing_mm = 2;
  const TissueMesh& mesh = *model.mesh;
  const auto slot = [&](int node) { return static_cast<std::size_t>(node); };
  std::vector<char> free(mesh.rest.size(), 0), known(mesh.rest.size(), 0);
  std::vector<MeshPoint> points;
  for (const MeshPoint& point : model.contact->points)
    if (point.count == 1) known[slot(point.node[0])] = free[slot(point.node[0])] = 1;
  std::vector<char> freed(mesh.rest.size(), 0);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const int node = mesh.elements.anchor_node[i];
    if (kept[i] >= loose || node % mesh.sheets != mesh.sheets - 1 || known[slot(node)]) continue;
    free[slot(node)] = freed[slot(node)] = 1;
  }
  for (std::size_t n = 0; n < freed.size(); ++n)
    if (freed[n]) points.push_back(MeshPoint::of_node(static_cast<int>(n)));
  std::vector<Eigen::Vector3i> between;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3i inner =
        t.unaryExpr([&](int c) { return node_of(c, mesh.sheets - 1, mesh.sheets); });
    bool all = true, any = false;
    for (const int node : inner) {
      all = all && free[slot(node)];
      any = any || freed[slot(node)];
    }
    if (all && any) between.push_back(inner);
  }
  spread(between, mesh.rest, spacing_mm, points);
  return points;
}

/// The contact with more points, on the same surfaces.
TissueContact with_points(const TissueModel& model, const std::vector<MeshPoint>& points) {
  TissueContact contact = *model.contact;
  TissueContact more;
  more.points = points;
  more.front.assign(points.size(), Eigen::Vector3d::Zero());
  contact.points.insert(contact.points.end(), points.begin(), points.end());
  contact.front.insert(contact.front.end(), more.front.begin(), more.front.end());
  contact.lower_lip.resize(contact.points.size(), 0);
  for (Obstacle& obstacle : contact.obstacles) {
    Obstacle added = obstacle;
    fit_to_rest(more, model.mesh->rest, {}, added);
    const auto append = [](auto& to, const auto& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(obstacle.shift, added.shift);
    append(obstacle.allowance, added.allowance);
    append(obstacle.near_at_rest, added.near_at_rest);
    append(obstacle.front_guided, added.front_guided);
  }
  return contact;
}

}  // namespace

std::shared_ptr<const TissueModel> strip_anchors(const std::shared_ptr<const TissueModel>& model,
                                                 std::span<const double> kept) {
  assert(kept.size() == model->mesh->elements.anchor_node.size());
  if (std::all_of(kept.begin(), kept.end(), [](double k) { return k == 1; })) return model;
  auto stripped = std::make_shared<TissueModel>(*model);
  auto mesh = std::make_shared<TissueMesh>(*model->mesh);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    assert(kept[i] > 0 && kept[i] <= 1);
    mesh->elements.anchor_stiffness[i] *= kept[i];
    if (!stripped->support.anchor_offset.empty()) stripped->support.anchor_offset[i] /= kept[i];
  }
  stripped->mesh = mesh;
  if (const auto points = freed_points(*model, kept); !points.empty())
    stripped->contact = std::make_shared<const TissueContact>(with_points(*model, points));
  return stripped;
}

}  // namespace condyle
