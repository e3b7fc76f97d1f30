#include "sim/tissue/tissue_contact.h"

#include <algorithm>
#include <map>

#include "engine/mesh/measure.h"
#include "engine/tissue/layered_net.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

constexpr double lip_mm = 16;  // of the lips' surfaces, from the mouth's line
constexpr double lip_edge_mm =
    7;                           // of the points that may meet the other lip, or teeth from before
constexpr double corner_mm = 5;  // nearer to a corner both lips are one
constexpr double deepest_lip_mm = 0.4;
constexpr double lip_stiffness = 0.5;  // N/mm; lips give way to each other themselves
constexpr double swept_mm = 10;        // points come this far from where they rest, beside the jaw

/// Surface of the lip on one side: skin, the edge between skin and inner side, and that.
std::vector<Triangle> lip_surface(const ContactSource& from, int side) {
  const auto on_lip = [&](int column) {
    return from.columns[column].to_mouth < lip_mm &&
           (from.side[column] == side || from.columns[column].to_mouth == 0);
  };
  const auto node = [&](int column, int sheet) { return node_of(column, sheet, from.sheets); };
  std::vector<Triangle> surface;
  std::map<std::pair<int, int>, int> edges;  // directed edges of the lip's triangles
  const int last = from.sheets - 1;
  for (const auto& t : from.skin.mesh.triangles) {
    if (!on_lip(t[0]) || !on_lip(t[1]) || !on_lip(t[2])) continue;
    if (from.side[t[0]] != side && from.side[t[1]] != side && from.side[t[2]] != side) continue;
    surface.push_back({node(t[0], 0), node(t[1], 0), node(t[2], 0)});
    surface.push_back({node(t[0], last), node(t[2], last), node(t[1], last)});
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  const auto wall = [&](int a, int b) {  // the skin's border runs from a to b
    for (int s = 0; s < last; ++s) {
      surface.push_back({node(a, s), node(a, s + 1), node(b, s + 1)});
      surface.push_back({node(a, s), node(b, s + 1), node(b, s)});
    }
  };
  std::vector<int> run = side > 0 ? from.skin.mouth.upper : from.skin.mouth.lower;
  run.insert(run.begin(), from.skin.mouth.right_corner);
  run.push_back(from.skin.mouth.left_corner);
  for (std::size_t i = 0; i + 1 < run.size(); ++i) {
    if (edges.count({run[i], run[i + 1]}) > 0) wall(run[i], run[i + 1]);
    if (edges.count({run[i + 1], run[i]}) > 0) wall(run[i + 1], run[i]);
  }
  return surface;
}

TissueContact::Lip make_lip(const ContactSource& from, int side) {
  TissueContact::Lip lip;
  if (!from.skin.mouth.found()) return lip;
  lip.surface = lip_surface(from, side);
  const auto& vertices = from.skin.mesh.vertices;
  for (std::size_t c = 0; c < from.columns.size(); ++c) {
    if (from.side[c] != side || from.columns[c].to_mouth > lip_edge_mm) continue;
    const auto to = [&](int corner) { return (vertices[c] - vertices[corner]).norm(); };
    if (std::min(to(from.skin.mouth.right_corner), to(from.skin.mouth.left_corner)) < corner_mm)
      continue;
    for (int s = 0; s < from.sheets; ++s)
      lip.points.push_back(NetPoint::of_node(node_of(static_cast<int>(c), s, from.sheets)));
  }
  lip.allowance.assign(lip.points.size(), 0.0);
  return lip;
}

/// Takes out points so deep in the other lip at rest that nothing tells which way is out. Returns
/// how many.
int leave_out_deep(const std::vector<Touch>& touches, TissueContact::Lip& lip) {
  std::vector<char> deep(lip.points.size(), 0);
  for (const auto& touch : touches) deep[touch.point] = touch.gap < -deepest_lip_mm;
  std::vector<NetPoint> kept;
  for (std::size_t i = 0; i < lip.points.size(); ++i)
    if (!deep[i]) kept.push_back(lip.points[i]);
  const int gone = static_cast<int>(lip.points.size() - kept.size());
  lip.points = std::move(kept);
  lip.allowance.assign(lip.points.size(), 0.0);
  return gone;
}

TissueContact::Jaw make_jaw(const TissueContact& contact, const Nodes& rest, const TriMesh& mesh,
                            int threads) {
  TissueContact::Jaw jaw;
  jaw.allowance.assign(contact.points.size(), 0.0);
  jaw.near_at_rest.assign(contact.points.size(), 0);
  if (mesh.empty() || contact.points.empty()) return jaw;
  Box region;
  for (const auto& point : contact.points) region.add(point.at(rest));
  region.low.array() -= swept_mm;
  region.high.array() += swept_mm;
  jaw.obstacle = std::make_shared<NetObstacle>(mesh, region, field_cache_folder(), threads);
  std::vector<Touch> touches;
  touch_obstacle(contact.points, jaw.allowance, *jaw.obstacle, Pose{}, rest, {}, touches);
  allow(touches, jaw.allowance);
  for (const auto& touch : touches) jaw.near_at_rest[touch.point] = 1;
  return jaw;
}

}  // namespace

std::vector<std::array<int, 2>> lips_that_may_touch(const TissueContact& contact,
                                                    const Nodes& rest) {
  constexpr double near_mm = 6;
  std::vector<std::array<int, 2>> pairs;
  const auto add = [&](const TissueContact::Lip& lip, const TissueContact::Lip& other) {
    for (const auto& point : lip.points)
      for (const auto& triangle : other.surface)
        for (int node : triangle)
          if ((rest[point.node[0]] - rest[node]).norm() < near_mm)
            pairs.push_back({point.node[0], node});
  };
  add(contact.upper, contact.lower);
  add(contact.lower, contact.upper);
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

TissueContact make_contact(const ContactSource& from, const TriMesh& cranium,
                           const TriMesh& mandible, int threads) {
  TissueContact contact;
  const int last = from.sheets - 1;
  const auto free = [&](int node) { return !from.held[node]; };
  for (std::size_t c = 0; c < from.columns.size(); ++c) {
    const bool lip = from.columns[c].to_mouth < lip_edge_mm;
    for (int s = lip ? 0 : last; s <= last; ++s)
      if (const int node = node_of(static_cast<int>(c), s, from.sheets); free(node))
        contact.points.push_back(NetPoint::of_node(node));
  }
  for (const auto& t : from.skin.mesh.triangles) {
    const int a = node_of(t[0], last, from.sheets), b = node_of(t[1], last, from.sheets),
              c = node_of(t[2], last, from.sheets);
    if (free(a) && free(b) && free(c)) contact.points.push_back(NetPoint::centre(a, b, c));
  }
  contact.cranium = make_jaw(contact, from.rest, cranium, threads);
  contact.mandible = make_jaw(contact, from.rest, mandible, threads);

  contact.upper = make_lip(from, 1);
  contact.lower = make_lip(from, -1);
  for (const auto& [lip, other] :
       {std::pair{&contact.upper, &contact.lower}, std::pair{&contact.lower, &contact.upper}}) {
    std::vector<Touch> touches;
    touch_surface(lip->points, lip->allowance, other->surface, from.rest, {}, touches);
    contact.lip_points_left_out += leave_out_deep(touches, *lip);
    touches.clear();
    touch_surface(lip->points, lip->allowance, other->surface, from.rest, {}, touches);
    allow(touches, lip->allowance);
  }
  return contact;
}

Looks look_at(const TissueContact& contact, const Pose& X_CM, const Nodes& x) {
  Looks looks(4);
  const TouchSettings settings;
  if (contact.cranium.obstacle)
    touch_obstacle(contact.points, contact.cranium.allowance, *contact.cranium.obstacle, Pose{}, x,
                   settings, looks[on_cranium]);
  if (contact.mandible.obstacle)
    touch_obstacle(contact.points, contact.mandible.allowance, *contact.mandible.obstacle, X_CM, x,
                   settings, looks[on_mandible]);
  const TouchSettings soft{.stiffness = lip_stiffness};
  touch_surface(contact.upper.points, contact.upper.allowance, contact.lower.surface, x, soft,
                looks[upper_on_lower]);
  touch_surface(contact.lower.points, contact.lower.allowance, contact.upper.surface, x, soft,
                looks[lower_on_upper]);
  return looks;
}

ContactMeasure measure_contact(const TissueContact& contact, const Looks& looks, const Pose& X_CM,
                               const Nodes& rest, const Nodes& x) {
  ContactMeasure measure;
  for (const auto& touches : looks)
    for (const auto& touch : touches)
      measure.penetration_mm = std::max(measure.penetration_mm, -touch.gap);
  for (const auto* allowance : {&contact.cranium.allowance, &contact.mandible.allowance,
                                &contact.upper.allowance, &contact.lower.allowance})
    for (double depth : *allowance)
      measure.rest_overlap_mm = std::max(measure.rest_overlap_mm, depth);
  const auto slip = [&](const TissueContact::Jaw& jaw, const Pose& X_CJ,
                        const std::vector<Touch>& touches) {
    for (const auto& touch : touches) {
      if (!jaw.near_at_rest[touch.point]) continue;
      const NetPoint& point = contact.points[touch.point];
      const Vector3d way = point.at(x) - X_CJ * point.at(rest);
      const Vector3d along = way - way.dot(touch.row.normal) * touch.row.normal;
      measure.slip_mm = std::max(measure.slip_mm, along.norm());
    }
  };
  slip(contact.cranium, Pose{}, looks[on_cranium]);
  slip(contact.mandible, X_CM, looks[on_mandible]);
  return measure;
}

}  // namespace condyle
