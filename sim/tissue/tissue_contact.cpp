#include "sim/tissue/tissue_contact.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "engine/core/parallel.h"
#include "engine/mesh/measure.h"
#include "engine/tissue/layered_net.h"

namespace condyle {
namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

/// Between nodes 5 mm and more apart bones and teeth would stand in the flat faces by up to 2 mm:
/// there more points may meet them, so close together, and keep a distance, as far as they have it
/// at rest.
constexpr double near_mm = 1.5;  // near the mouth, where teeth have edges
constexpr double far_mm = 2;
constexpr double kept_mm = 0.25;
constexpr double slack_mm = 0.1;  // that at rest little presses when it is stirred
constexpr double near_mouth_mm = 18;
constexpr double teeth_lip_edge_mm = 7;  // of the points that may meet teeth from before
constexpr double led_mm = 14;            // of the points that are led before the teeth
constexpr double whole_mm = 7;           // of the lip that the other one meets
constexpr double corner_mm = 5;          // nearer to a corner both lips are one
constexpr double deepest_lip_mm = 0.4;
constexpr double apart_mm = 0.02;       // between the lips when their nodes have been moved apart
constexpr double lips_stiffness = 0.5;  // N/mm; lips give way to each other themselves
constexpr double skin_stiffness = 1;    // N/mm; as much as needs the fewest iterations
constexpr double swept_mm = 10;         // points come this far from where they rest, beside the jaw

/// Columns along one lip's edge, from the right corner to the left, both with.
std::vector<int> lip_edge(const ContactSource& from, int side) {
  std::vector<int> run = side > 0 ? from.skin.mouth.upper : from.skin.mouth.lower;
  run.insert(run.begin(), from.skin.mouth.right_corner);
  run.push_back(from.skin.mouth.left_corner);
  return run;
}

/// The side of the lip that meets the other lip: from the skin's edge inward.
std::vector<Triangle> edge_faces(const ContactSource& from, int side) {
  std::map<std::pair<int, int>, int> edges;  // directed edges of the skin
  for (const auto& t : from.skin.mesh.triangles)
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  std::vector<Triangle> surface;
  const auto node = [&](int column, int sheet) { return node_of(column, sheet, from.sheets); };
  const auto wall = [&](int a, int b) {  // the skin's border runs from a to b
    for (int s = 0; s + 1 < from.sheets; ++s) {
      surface.push_back({node(a, s), node(a, s + 1), node(b, s + 1)});
      surface.push_back({node(a, s), node(b, s + 1), node(b, s)});
    }
  };
  const std::vector<int> run = lip_edge(from, side);
  for (std::size_t i = 0; i + 1 < run.size(); ++i) {
    if (edges.count({run[i], run[i + 1]}) > 0) wall(run[i], run[i + 1]);
    if (edges.count({run[i + 1], run[i]}) > 0) wall(run[i + 1], run[i]);
  }
  return surface;
}

/// The lip's edge with what is around it: alone it would count what lies before it as inside.
std::vector<Triangle> whole_lip(const ContactSource& from, int side, std::vector<Triangle> edge) {
  const int inner = from.sheets - 1;
  const auto node = [&](int column, int sheet) { return node_of(column, sheet, from.sheets); };
  for (const auto& t : from.skin.mesh.triangles) {
    if (!std::all_of(t.begin(), t.end(), [&](int c) {
          return from.side[c] * side > 0 && from.columns[c].to_mouth < whole_mm;
        }))
      continue;
    edge.push_back({node(t[0], 0), node(t[1], 0), node(t[2], 0)});
    edge.push_back({node(t[0], inner), node(t[2], inner), node(t[1], inner)});
  }
  return edge;
}

TissueContact::Lip make_lip(const ContactSource& from, int side) {
  TissueContact::Lip lip;
  if (!from.skin.mouth.found()) return lip;
  lip.edge = edge_faces(from, side);
  for (const auto& [a, b, c] : lip.edge)
    lip.facing += (from.rest[b] - from.rest[a]).cross(from.rest[c] - from.rest[a]);
  lip.facing.normalize();
  lip.surface = NetSurface(whole_lip(from, side, lip.edge), from.rest);
  const auto& vertices = from.skin.mesh.vertices;
  for (int c : lip_edge(from, side)) {
    const auto to = [&](int corner) { return (vertices[c] - vertices[corner]).norm(); };
    if (std::min(to(from.skin.mouth.right_corner), to(from.skin.mouth.left_corner)) < corner_mm)
      continue;
    for (int s = 0; s < from.sheets; ++s)
      lip.points.push_back(NetPoint::of_node(node_of(c, s, from.sheets)));
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

/// Ways of the two ends of each column, outer and inner; between them it stays straight.
struct ColumnWays {
  Nodes sum;
  std::vector<double> weight;
  explicit ColumnWays(std::size_t columns)
      : sum(2 * columns, Vector3d::Zero()), weight(2 * columns, 0.0) {}

  void add(std::size_t column, double fraction, const Vector3d& way) {
    sum[2 * column] += (1 - fraction) * way;
    weight[2 * column] += 1 - fraction;
    sum[2 * column + 1] += fraction * way;
    weight[2 * column + 1] += fraction;
  }
  Vector3d way(std::size_t column, double fraction) const {
    const auto end = [&](std::size_t i) {
      return weight[i] > 0 ? Vector3d(sum[i] / weight[i]) : Vector3d(Vector3d::Zero());
    };
    return (1 - fraction) * end(2 * column) + fraction * end(2 * column + 1);
  }
  void stop(std::size_t column) { weight[2 * column] = weight[2 * column + 1] = 0; }
};

/// Cosine between the plane of a point that is led and its front.
constexpr double least_front = 0.5;

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
  jaw.shift.assign(contact.points.size(), Vector3d::Zero());
  jaw.led.resize(contact.points.size());
  for (std::size_t i = 0; i < jaw.led.size(); ++i) jaw.led[i] = !contact.front[i].isZero();
  for (const auto& touch : touches) {
    // What rests under a tooth's edge would not find back there.
    if (touch.row.normal.dot(contact.front[touch.point]) < least_front) jaw.led[touch.point] = 0;
    jaw.near_at_rest[touch.point] = 1;
    if (touch.gap < 0) jaw.shift[touch.point] = jaw.obstacle->way_out(touch.at);
  }
  touches.clear();
  touch_obstacle(contact.points, jaw.allowance, *jaw.obstacle, Pose{}, rest, {}, touches,
                 jaw.shift);
  allow(touches, jaw.allowance);
  std::vector<double> kept(contact.points.size(), kept_mm);
  for (const auto& touch : touches)
    kept[touch.point] = std::clamp(touch.gap - slack_mm, 0.0, kept_mm);
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (contact.points[i].count > 1) jaw.allowance[i] -= kept[i];
  return jaw;
}

/// Where the teeth's edges would let a lip's point go either way, it is led to the front.
void lead_lips(const TissueContact& contact, const TissueContact::Jaw& jaw, const Pose& X_CM,
               const Nodes& x, std::vector<Touch>& touches) {
  for (auto& touch : touches) {
    if (!jaw.led[touch.point]) continue;
    Vector3d front = contact.front[touch.point];
    if (contact.lower_lip[touch.point]) front = X_CM.R * front;
    if (touch.row.normal.dot(front) >= least_front) continue;
    touch.row.normal = led(touch.row.normal, front, least_front);
    touch.row.offset = touch.row.along(x) - touch.gap;
  }
}

}  // namespace

double part_closed_lips(const ContactSource& from, Nodes& rest) {
  constexpr int most_rounds = 60;
  constexpr double least_share = 0.4;  // of a prism's volume that must remain
  const TissueContact::Lip upper = make_lip(from, +1), lower = make_lip(from, -1);
  const NetSurface upper_edge(upper.edge, rest), lower_edge(lower.edge, rest);
  const Nodes before = rest;
  const auto fraction = [&](int node) {
    const int outer = node - node % from.sheets, inner = outer + from.sheets - 1;
    return (before[node] - before[outer]).norm() / (before[inner] - before[outer]).norm();
  };
  const auto sound = [&](const Eigen::Vector3i& t) {
    for (int s = 0; s + 1 < from.sheets; ++s) {
      std::array<int, 6> prism;
      for (int k = 0; k < 3; ++k) {
        prism[k] = node_of(t[k], s, from.sheets);
        prism[k + 3] = node_of(t[k], s + 1, from.sheets);
      }
      if (prism_volume(rest, prism) < least_share * prism_volume(before, prism)) return false;
    }
    return true;
  };
  for (int round = 0; round < most_rounds; ++round) {
    std::vector<Touch> touches;
    touch_surface(upper.points, upper.allowance, lower_edge, rest, {}, touches);
    touch_surface(lower.points, lower.allowance, upper_edge, rest, {}, touches);
    ColumnWays ways(from.columns.size());
    bool any = false;
    for (const auto& touch : touches) {
      if (touch.gap >= 0) continue;
      any = true;
      const ContactRow& row = touch.row;
      double square = 0;
      for (int k = 0; k < row.count; ++k) square += row.weight[k] * row.weight[k];
      for (int k = 0; k < row.count; ++k)
        ways.add(row.node[k] / from.sheets, fraction(row.node[k]),
                 (apart_mm - touch.gap) * row.weight[k] / square * row.normal);
    }
    if (!any) break;
    const Nodes last = rest;
    const auto move = [&](int column) {
      for (int s = 0; s < from.sheets; ++s) {
        const int node = node_of(column, s, from.sheets);
        rest[node] = last[node] + ways.way(column, fraction(node));
      }
    };
    for (std::size_t c = 0; c < from.columns.size(); ++c) move(static_cast<int>(c));
    for (const auto& t : from.skin.mesh.triangles)
      if (!sound(t))
        for (int column : t) {
          ways.stop(column);
          move(column);
        }
  }
  double farthest = 0;
  for (std::size_t n = 0; n < rest.size(); ++n)
    farthest = std::max(farthest, (rest[n] - before[n]).norm());
  return farthest;
}

std::vector<std::array<int, 2>> lips_that_may_touch(const TissueContact& contact,
                                                    const Nodes& rest) {
  constexpr double beside_mm = 6;
  std::vector<std::array<int, 2>> pairs;
  const auto add = [&](const TissueContact::Lip& lip, const TissueContact::Lip& other) {
    for (const auto& point : lip.points)
      for (const auto& triangle : other.edge)
        for (int node : triangle)
          if ((rest[point.node[0]] - rest[node]).norm() < beside_mm)
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
    const bool lip = from.columns[c].to_mouth < teeth_lip_edge_mm;
    for (int s = lip ? 0 : last; s <= last; ++s)
      if (const int node = node_of(static_cast<int>(c), s, from.sheets); free(node))
        contact.points.push_back(NetPoint::of_node(node));
  }
  std::vector<Eigen::Vector3i> before_teeth, sliding;
  for (const auto& t : from.skin.mesh.triangles) {
    const Eigen::Vector3i inner = t.unaryExpr([&](int c) { return node_of(c, last, from.sheets); });
    if (!free(inner[0]) || !free(inner[1]) || !free(inner[2])) continue;
    double to_mouth = 0;
    for (int c : t) to_mouth = std::max(to_mouth, from.columns[c].to_mouth);
    (to_mouth < near_mouth_mm ? before_teeth : sliding).push_back(inner);
  }
  contact.upper = make_lip(from, 1);
  contact.lower = make_lip(from, -1);
  for (const auto* lip : {&contact.upper, &contact.lower})
    for (const auto& [a, b, c] : lip->edge) before_teeth.emplace_back(a, b, c);
  spread(before_teeth, from.rest, near_mm, contact.points);
  spread(sliding, from.rest, far_mm, contact.points);
  for (const auto& point : contact.points) {
    Vector3d front = Vector3d::Zero();
    bool lip = true;
    for (int k = 0; k < point.count; ++k) {
      const int column = point.node[k] / from.sheets;
      lip = lip && from.columns[column].to_mouth < led_mm;
      front -= from.columns[column].inward;
    }
    contact.front.push_back(lip ? Vector3d(front.normalized()) : Vector3d::Zero());
    contact.lower_lip.push_back(from.side[point.node[0] / from.sheets] < 0);
  }
  contact.cranium = make_jaw(contact, from.rest, cranium, threads);
  contact.mandible = make_jaw(contact, from.rest, mandible, threads);

  for (const auto& [lip, other] :
       {std::pair{&contact.upper, &contact.lower}, std::pair{&contact.lower, &contact.upper}}) {
    std::vector<Touch> touches;
    touch_surface(lip->points, lip->allowance, other->surface, from.rest, {}, touches,
                  other->facing);
    contact.lip_points_left_out += leave_out_deep(touches, *lip);
    touches.clear();
    touch_surface(lip->points, lip->allowance, other->surface, from.rest, {}, touches,
                  other->facing);
    allow(touches, lip->allowance);
  }
  contact.fold = find_fold(from);
  return contact;
}

Looks look_at(const TissueContact& contact, const Pose& X_CM, const Nodes& x, int threads,
              NearJaws* known, double firmness) {
  firmness *= contact.firmness;
  const TouchSettings on_jaw{.stiffness = firmness * TouchSettings{}.stiffness};
  Looks looks(contact_lists);
  const auto jaw = [&](const TissueContact::Jaw& of, const Pose& X_CJ, std::vector<Touch>& touches,
                       NearPoints* near) {
    if (!of.obstacle) return;
    touch_obstacle(contact.points, of.allowance, *of.obstacle, X_CJ, x, on_jaw, touches, of.shift,
                   near);
    lead_lips(contact, of, X_CM, x, touches);
  };
  const auto flap = [&](const Flap& of, const Flap& on, double stiffness,
                        std::vector<Touch>& touches, const Vector3d& facing = Vector3d::Zero()) {
    touch_surface(of.points, of.allowance, on.surface, x, {.stiffness = firmness * stiffness},
                  touches, facing);
  };
  const auto& [upper, lower] = std::tie(contact.upper, contact.lower);
  const auto& [chin, throat] = contact.fold;
  parallel_for(2, threads, [&](std::size_t i) {
    if (i == 0) {
      jaw(contact.cranium, Pose{}, looks[on_cranium], known ? &known->cranium : nullptr);
      flap(upper, lower, lips_stiffness, looks[upper_on_lower], X_CM.R * lower.facing);
      flap(chin, throat, skin_stiffness, looks[chin_on_throat]);
    } else {
      jaw(contact.mandible, X_CM, looks[on_mandible], known ? &known->mandible : nullptr);
      flap(lower, upper, lips_stiffness, looks[lower_on_upper], upper.facing);
      flap(throat, chin, skin_stiffness, looks[throat_on_chin]);
    }
  });
  return looks;
}

ContactMeasure measure_contact(const TissueContact& contact, const Looks& looks, const Pose& X_CM,
                               const Nodes& rest, const Nodes& x) {
  ContactMeasure measure;
  for (const auto& touches : looks)
    for (const auto& touch : touches)
      measure.penetration_mm = std::max(measure.penetration_mm, -touch.gap);
  for (const auto* jaw : {&contact.cranium, &contact.mandible})
    for (std::size_t i = 0; i < jaw->shift.size(); ++i)
      measure.rest_overlap_mm =
          std::max(measure.rest_overlap_mm, jaw->shift[i].norm() + jaw->allowance[i]);
  for (const auto* lip : {&contact.upper, &contact.lower})
    for (double depth : lip->allowance)
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
